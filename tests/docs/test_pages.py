"""The pages of the documentation: their code runs, block after block."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
TESTED_BY_THEIR_OWN = {"extending.md", "repertoires.md"}


def blocks_of(page: Path) -> list[str]:
    return re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL)


PAGES = [page.name for page in sorted(DOCS.glob("*.md")) if blocks_of(page) and page.name not in TESTED_BY_THEIR_OWN]


@pytest.mark.slow
@pytest.mark.parametrize("name", PAGES)
def test_the_code_blocks_run_in_order(name, tmp_path):
    script = tmp_path / "page.py"
    script.write_text("\n".join(blocks_of(DOCS / name)), encoding="utf-8")
    done = subprocess.run([sys.executable, str(script)], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_there_are_pages_with_code():
    assert {"diagrams.md", "learning.md"} <= set(PAGES)
