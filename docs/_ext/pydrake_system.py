"""The directive `.. pydrake_system::` of Drake's docstrings, drawn as a box with its ports.

Its content is YAML with `name`, `input_ports` and `output_ports`, as in Drake's own documentation. The picture is SVG
in the page itself, in the colors of the page.
"""

from html import escape

import yaml
from docutils import nodes
from docutils.parsers.rst import Directive

_CHARACTER, _ROW, _GAP, _ARROW = 8.0, 24.0, 14.0, 44.0  # px: width of a letter, height of a port, between, of an arrow


def ports_svg(name: str, inputs: list[str], outputs: list[str]) -> str:
    """A box with the name of a System, its inputs at the left, and its outputs at the right."""
    left, right = (max((len(port) for port in ports), default=0) * _CHARACTER for ports in (inputs, outputs))
    width = max(left + right + 3.0 * _GAP, len(name) * _CHARACTER * 1.2 + 2.0 * _GAP)
    height = _ROW * (max(len(inputs), len(outputs)) + 1.6)
    total = width + 2.0 * _ARROW
    parts = [
        f'<svg class="pydrake-system" viewBox="0 0 {total:g} {height + 2:g}" width="{total:g}" role="img" '
        f'aria-label="The ports of {escape(name)}">',
        f'<rect x="{_ARROW:g}" y="1" width="{width:g}" height="{height:g}" rx="6"/>',
        f'<text class="name" x="{total / 2:g}" y="{_ROW:g}" text-anchor="middle">{escape(name)}</text>',
    ]
    for ports, edge, anchor, label in (
        (inputs, 0.0, "start", _ARROW + _GAP),
        (outputs, _ARROW + width, "end", _ARROW + width - _GAP),
    ):
        for row, port in enumerate(ports):
            y = _ROW * (row + 2.1)
            tip = edge + _ARROW - 2.0
            parts.append(f'<path d="M{edge + 2:g} {y:g}H{tip:g}m-8 -4l8 4l-8 4"/>')
            parts.append(f'<text x="{label:g}" y="{y + 4.5:g}" text-anchor="{anchor}">{escape(port)}</text>')
    return "".join([*parts, "</svg>"])


class PydrakeSystem(Directive):
    has_content = True

    def run(self) -> list[nodes.Node]:
        system = yaml.safe_load("\n".join(self.content))
        inputs, outputs = (list(map(str, system.get(key) or [])) for key in ("input_ports", "output_ports"))
        return [nodes.raw("", ports_svg(system["name"], inputs, outputs), format="html")]


def setup(app):
    app.add_directive("pydrake_system", PydrakeSystem)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
