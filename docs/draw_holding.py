"""Draws which postures arm14 can hold against gravity, docs/holding.png: `python docs/draw_holding.py`."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from drakearm.errors import EquilibriumError
from drakearm.figures.style import save_picture
from drakearm.model import Arm, find_equilibrium, load_arm

PICTURE = Path(__file__).with_name("holding.png")
SHOULDER, ELBOW = np.arange(-75.0, 76.0, 2.5), np.arange(0.0, 131.0, 2.5)  # deg


def largest_excitation(arm: Arm, q: np.ndarray) -> float:
    """Of the excitations that hold a posture q (n_q,), rad; NaN if the muscles cannot hold it."""
    try:
        return float(find_equilibrium(arm, q).excitation.max())
    except EquilibriumError:
        return np.nan


def draw(arm: Arm) -> Figure:
    postures = [[np.deg2rad([shoulder, elbow]) for shoulder in SHOULDER] for elbow in ELBOW]
    largest = np.array([[largest_excitation(arm, q) for q in row] for row in postures])
    figure = Figure(figsize=(7.0, 4.0), layout="constrained")
    axes = figure.add_subplot()
    axes.set_facecolor("#FFFFFF")
    axes.patch.set(hatch="////", edgecolor="#AAAAAA")
    filled = axes.contourf(SHOULDER, ELBOW, largest, np.linspace(0.0, 1.0, 11), cmap="viridis")
    lines = axes.contour(SHOULDER, ELBOW, largest, [0.2, 0.4, 0.6, 0.8], colors="white", linewidths=0.8)
    axes.clabel(lines, fmt="%.1f")
    axes.set(
        xlabel="shoulder (deg)", ylabel="elbow (deg)", title="largest excitation that holds arm14; hatched: cannot"
    )
    figure.colorbar(filled, label="largest excitation")
    return figure


if __name__ == "__main__":
    save_picture(draw(load_arm()), PICTURE, 120)
    print(f"wrote {PICTURE}")
