"""The page about repertoires: its code runs."""

import re
from pathlib import Path

import numpy as np

PAGE = (Path(__file__).parents[2] / "docs" / "repertoires.md").read_text()


def test_the_code_blocks_run_in_order(arm):
    scope = {"__name__": "page"}
    for block in re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL):
        exec(compile(block, "repertoires.md", "exec"), scope)
    q = scope["loop"].diagram.GetOutputPort("arm_state").Eval(scope["context"])[:2]
    np.testing.assert_allclose(q, np.deg2rad([10.0, 60.0]), atol=0.03)
    assert scope["ElbowOnly"](0.0).draw(arm, np.random.default_rng(0)).movement.start_deg[0] == 0.0
