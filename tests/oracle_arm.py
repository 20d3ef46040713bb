"""The arm on the polynomial paths that OpenSim's whole simulations were made with."""

import json
from dataclasses import replace
from math import comb

from numpy.polynomial import Polynomial

from drakearm.model import Arm, PathTerm

_RANGE = (-2.0, 3.0)  # rad: beyond all that the simulations reach


def on_polynomial_paths(arm: Arm, file) -> Arm:
    """The arm with the paths of smooth_paths.json, as one-piece splines."""
    paths = json.loads(file.read_text())["muscles"]
    muscles = []
    for muscle in arm.muscles:
        functions = {"shoulder": paths[muscle.name]["A"], "elbow": paths[muscle.name]["B"]}
        terms = tuple(_term(name, c) for name, c in functions.items() if any(c))
        muscles.append(replace(muscle, path=terms))
    return replace(arm, muscles=tuple(muscles))


def _term(coordinate: str, coefficients) -> PathTerm:
    """A polynomial as a B-spline of one piece, whose coefficients are those of Bernstein's basis."""
    low, high = _RANGE
    moved = Polynomial(coefficients)(Polynomial([low, high - low])).coef  # on [0, 1]
    degree = len(moved) - 1
    bernstein = [sum(comb(j, i) / comb(degree, i) * moved[i] for i in range(j + 1)) for j in range(degree + 1)]
    knots = (low,) * (degree + 1) + (high,) * (degree + 1)
    return PathTerm(coordinate, knots, tuple(bernstein))
