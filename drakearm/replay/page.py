"""The web page of a replay: Meshcat's page with a caption, and a strip of angles and activations, and its controls.

What the browser does is beside this file: in page.js for a scene, in controls.js for the clock and the controls.
"""

import html
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import cache
from pathlib import Path
from string import Template

import numpy as np
from pydrake.geometry import Rgba

from drakearm.model import Arm
from drakearm.model.recording import Recording
from drakearm.replay.movement import Caption, duration
from drakearm.replay.scene import GHOST_COLOR, PATH_COLOR, TARGET_COLOR, TARGET_RADIUS, View, drawing_scale
from drakearm.systems.muscle_drawing import activation_color

JOINT_COLORS = ("#3b8ed0", "#e0803c", "#2fae86", "#c97bb0", "#d2a52a", "#7fb7dd")  # readable on white and on black
_SHADES = 64  # of the strip's colors
# Lets the browser refuse every request to another place: all that the page may load is inside of it.
POLICY = """
<meta http-equiv="Content-Security-Policy" content="default-src 'unsafe-inline' 'unsafe-eval' data: blob:">
<meta name="viewport" content="width=device-width, initial-scale=1">
"""
# Meshcat's page runs each command as soon as it is decoded, in any order. But an animation of colors only works on
# objects that exist already. This script makes the page run the commands in their original order.
_ORDER = """
<script>
  const unordered_fetch = window.fetch;
  let commands = Promise.resolve();
  window.fetch = request => {
    const command = unordered_fetch(request).then(response => response.arrayBuffer());
    const turn = commands = commands.then(() => command);
    return Promise.resolve({ arrayBuffer: () => turn });
  };
</script>
"""


def make_page(
    meshcat_html: str,
    caption: Caption,
    speed: float,
    recording: Recording,
    arm: Arm,
    views: Mapping[str, View],
    load_mass: float = 0.0,
    together: Sequence[Recording] = (),
) -> str:
    """Adds caption, strip and controls to the page of `Meshcat.StaticHtml()`.

    speed: of the animation, as a fraction of real time. recording: the movement that it shows. views: of the buttons.
    load_mass: kg, which is written beside the load. together: all recordings of a comparison, if the page is a part of
    one. Then the controls are missing, and the strips of all parts have the same axes.
    """
    shown = together or [recording]
    angles = np.rad2deg(np.concatenate([q.ravel() for each in shown for q in (each.q, each.reference_q)]))
    data = {
        "speed": speed,
        "duration": duration(recording),
        "span": max(map(duration, shown)),
        "angles": [float(angles.min()), max(float(angles.max()), float(angles.min()) + 1.0)],
        "views": {name: asdict(view) for name, view in views.items()},
        "t": np.round(recording.t - recording.t[0], 4).tolist(),
        "q": np.round(np.rad2deg(recording.q), 2).tolist(),
        "reference_q": np.round(np.rad2deg(recording.reference_q), 2).tolist(),
        "activation": np.round(recording.activation, 3).tolist(),
        "joints": list(arm.coordinates),
        "joint_colors": [JOINT_COLORS[j % len(JOINT_COLORS)] for j in range(len(arm.coordinates))],
        "muscles": [muscle.name for muscle in arm.muscles],
        "ramp": _ramp(),
        "load": f"{load_mass:g} kg" if load_mass > 0.0 else "",
    }
    overlay = Template(part("page.html")).substitute(
        style=part("page.css"),
        script=part("rendering.js") + part("page.js") + ("" if together else part("controls.js")),
        caption=caption.html,
        controls="" if together else make_controls(duration(recording), [arm]),
        data=as_json(data),
    )
    page = meshcat_html.replace("<title>Drake MeshCat</title>", f"<title>{html.escape(caption.title)}</title>")
    page = page.replace("<head>", f"<head>{POLICY}", 1).replace("</head>", f"{_ORDER}</head>")
    if together:
        page = page.replace("<body>", '<body class="beside">', 1)
    return page.replace("</body>", f"{overlay}</body>")


def make_controls(seconds: float, arms: Sequence[Arm]) -> str:
    """The legend and the controls of a replay that lasts some seconds. arms: those that it shows."""
    radii = sorted({100 * TARGET_RADIUS * drawing_scale(arm) for arm in arms})
    return Template(part("controls.html")).substitute(
        ramp=", ".join(_ramp()[:: _SHADES // 8]),
        ghost=_css(GHOST_COLOR),
        path=_css(PATH_COLOR),
        target=_css(TARGET_COLOR),
        target_size=" or ".join(f"{radius:.2g}" for radius in radii) + " cm",
        duration=repr(seconds),
    )


def as_json(data: object) -> str:
    """JSON inside of a page: no text in it can end the script that it stands in."""
    return json.dumps(data).replace("<", "\\u003c")


@cache
def part(name: str) -> str:
    """The content of a file beside this one."""
    return Path(__file__).with_name(name).read_text(encoding="utf-8")


@cache
def _ramp() -> list[str]:
    return [_css(Rgba(*color)) for color in activation_color(np.linspace(0.0, 1.0, _SHADES))]


def _css(color: Rgba) -> str:
    red, green, blue = (round(255 * c) for c in (color.r(), color.g(), color.b()))
    return f"rgba({red}, {green}, {blue}, {color.a():g})"
