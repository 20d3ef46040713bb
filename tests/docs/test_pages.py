"""The pages of the documentation: their code runs, block after block, and how-tos are short."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
TESTED_BY_THEIR_OWN = {"extending.md", "repertoires.md"}
LONGEST = 30  # lines of a block in a how-to


def blocks_of(page: Path) -> list[str]:
    return re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL)


def names_of(pages) -> list[str]:
    return [str(page.relative_to(DOCS)) for page in sorted(pages) if blocks_of(page)]


HOW_TOS = names_of(DOCS.glob("howto/*.md"))
PAGES = [name for name in names_of(DOCS.glob("*.md")) if name not in TESTED_BY_THEIR_OWN]


@pytest.mark.slow
@pytest.mark.extra
@pytest.mark.parametrize("name", [*PAGES, *HOW_TOS])
def test_the_code_blocks_run_in_order(name, tmp_path):
    script = tmp_path / "page.py"
    script.write_text("\n".join(blocks_of(DOCS / name)), encoding="utf-8")
    done = subprocess.run([sys.executable, str(script)], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", HOW_TOS)
def test_each_block_of_a_how_to_is_short(name):
    assert max(len(block.splitlines()) for block in blocks_of(DOCS / name)) <= LONGEST


def test_there_are_pages_with_code():
    assert {"diagrams.md", "learning.md"} <= set(PAGES) and len(HOW_TOS) >= 10
