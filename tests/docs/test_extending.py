"""The page about extending: its code runs, and the files and tests that it names exist."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "extending.md").read_text()


@pytest.mark.slow
def test_the_code_blocks_run_in_order(tmp_path):
    blocks = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    assert len(blocks) >= 8
    script = tmp_path / "extending.py"
    script.write_text("\n".join(blocks))
    done = subprocess.run([sys.executable, str(script)], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_named_files_exist():
    named = re.findall(r"`((?:tests|drakearm|systems|diagrams|examples)/[\w/.-]+)`", PAGE)
    assert len(named) > 10
    for name in named:
        assert (ROOT / name).exists(), name


def test_each_row_of_the_table_has_a_section():
    links = re.findall(r"^\| \[.*?\]\(#(.*?)\)", PAGE, flags=re.MULTILINE)
    headings = {h.lower().replace(" ", "-") for h in re.findall(r"^## (.*)$", PAGE, flags=re.MULTILINE)}
    assert len(links) == 11 and set(links) <= headings
