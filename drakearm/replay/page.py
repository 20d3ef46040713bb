"""The web page of a replay: Meshcat's page with a caption, a legend, controls, and a strip of angles and activations.

What the browser does is in page.html, page.css and page.js, which stand beside this file.
"""

import html
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from string import Template

import numpy as np
from pydrake.geometry import Rgba

from drakearm.model import Arm
from drakearm.model.recording import Recording
from drakearm.replay.scene import GHOST_COLOR, PATH_COLOR, TARGET_COLOR, TARGET_RADIUS, View, drawing_scale
from drakearm.systems.muscle_drawing import activation_color

JOINT_COLORS = ("#3b8ed0", "#e0803c", "#2fae86", "#c97bb0", "#d2a52a", "#7fb7dd")  # readable on white and on black
_SHADES = 64  # of the strip's colors
# Lets the browser refuse every request to another place: all that the page may load is inside of it.
_POLICY = """
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


@dataclass(frozen=True)
class Caption:
    """What stands above a replay: what moves, how well, and a verdict: green, or red if the movement failed."""

    title: str
    lines: Sequence[str] = ()
    verdict: str = ""
    failed: bool = False

    @property
    def html(self) -> str:
        lines = [f"<h1>{html.escape(self.title)}</h1>", *(f"<p>{html.escape(line)}</p>" for line in self.lines)]
        if self.verdict:
            lines.append(f'<p class="{"bad" if self.failed else "good"}">{html.escape(self.verdict)}</p>')
        return "".join(lines)


def make_page(
    meshcat_html: str,
    caption: Caption,
    speed: float,
    recording: Recording,
    arm: Arm,
    views: Mapping[str, View],
    load_mass: float = 0.0,
) -> str:
    """Adds all controls to the page of `Meshcat.StaticHtml()`.

    speed: of the animation, as a fraction of real time. recording: the movement that it shows. views: of the buttons.
    load_mass: kg, which is written beside the load.
    """
    title = html.escape(caption.title)
    duration = float(recording.t[-1] - recording.t[0])
    ramp = [_css(Rgba(*color)) for color in activation_color(np.linspace(0.0, 1.0, _SHADES))]
    data = {
        "speed": speed,
        "duration": duration,
        "views": {name: asdict(view) for name, view in views.items()},
        "t": np.round(recording.t - recording.t[0], 4).tolist(),
        "q": np.round(np.rad2deg(recording.q), 2).tolist(),
        "reference_q": np.round(np.rad2deg(recording.reference_q), 2).tolist(),
        "activation": np.round(recording.activation, 3).tolist(),
        "joints": list(arm.coordinates),
        "joint_colors": [JOINT_COLORS[j % len(JOINT_COLORS)] for j in range(len(arm.coordinates))],
        "muscles": [muscle.name for muscle in arm.muscles],
        "ramp": ramp,
        "load": f"{load_mass:g} kg" if load_mass > 0.0 else "",
    }
    overlay = Template(_file("page.html")).substitute(
        style=_file("page.css"),
        script=_file("page.js"),
        caption=caption.html,
        ramp=", ".join(ramp[:: _SHADES // 8]),
        ghost=_css(GHOST_COLOR),
        path=_css(PATH_COLOR),
        target=_css(TARGET_COLOR),
        target_size=f"{100 * TARGET_RADIUS * drawing_scale(arm):.2g} cm",
        duration=repr(duration),
        data=json.dumps(data).replace("<", "\\u003c"),  # so that no name can end the script
    )
    page = meshcat_html.replace("<title>Drake MeshCat</title>", f"<title>{title}</title>")
    page = page.replace("<head>", f"<head>{_POLICY}", 1).replace("</head>", f"{_ORDER}</head>")
    return page.replace("</body>", f"{overlay}</body>")


@cache
def _file(name: str) -> str:
    return Path(__file__).with_name(name).read_text(encoding="utf-8")


def _css(color: Rgba) -> str:
    red, green, blue = (round(255 * c) for c in (color.r(), color.g(), color.b()))
    return f"rgba({red}, {green}, {blue}, {color.a():g})"
