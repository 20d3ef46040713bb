"""The table of thirty tasks says how many lines each takes: at most 15, or that it is not possible."""

import re
from pathlib import Path

PAGE = (Path(__file__).parents[2] / "docs" / "tasks.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| \[(.*?)\]\(#.*?\) \| (\w+) \| .+ \|$", PAGE, flags=re.MULTILINE)
SECTIONS = {
    part.partition("\n")[0]: part.partition("\n")[2] for part in re.split(r"^### ", PAGE, flags=re.MULTILINE)[1:]
}
LONGEST = 15


def lines_of(section: str) -> int:
    blocks = re.findall(r"```\w*\n(.*?)```", section, flags=re.DOTALL)
    return sum(bool(line.strip()) for block in blocks for line in block.splitlines())


def test_there_are_thirty_tasks_with_a_section_each():
    assert len(ROWS) == 30 and [title for title, _ in ROWS] == list(SECTIONS)


def test_the_lines_are_those_of_the_programs():
    for title, lines in ROWS:
        found = lines_of(SECTIONS[title])
        if lines == "no":
            assert found == 0 and len(SECTIONS[title]) > 100, title  # it says why
        else:
            assert found == int(lines) <= LONGEST, title
