"""The picture of the packages shows the layers that the imports obey."""

import re
from pathlib import Path

from tests.test_layers import LAYERS

PICTURE = Path(__file__).parents[2] / "docs" / "_static" / "house.svg"


def test_the_house_has_every_package_on_its_floor():
    floors: dict[str, set[str]] = {}
    for y, name in re.findall(r'y="(\d+)" fill="#222"><tspan font-weight="bold">(\w+)</tspan>', PICTURE.read_text()):
        floors.setdefault(y, set()).add(name)
    assert [floors[y] for y in sorted(floors, key=int, reverse=True)] == LAYERS
