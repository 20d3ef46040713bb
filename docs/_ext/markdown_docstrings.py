"""What docstrings write as in Markdown, for Sphinx: tables between bars, and formulas that are indented."""

import re


def list_table(rows: list[str]) -> list[str]:
    """The lines of a Markdown table as those of reST's directive."""
    cells = [[cell.strip() for cell in row.strip().strip("|").split("|")] for row in rows]
    lines = ["", ".. list-table::", "   :header-rows: 1", ""]
    for row in [cells[0], *cells[2:]]:
        lines += [("   * - " if column == 0 else "     - ") + cell for column, cell in enumerate(row)]
    return [*lines, ""]


def to_rest(lines: list[str]) -> list[str]:
    """A docstring's lines with tables as directives, and indented blocks after a colon as literal ones."""
    done, table = [], []
    for number, line in enumerate(lines):
        if re.match(r"\s*\|.*\|\s*$", line):
            table.append(line)
            continue
        if table:
            done += list_table(table)
            table = []
        following = next((later for later in lines[number + 1 :] if later.strip()), "")
        opens = line.endswith(":") and not line.endswith("::") and not line.startswith((" ", ".."))
        done.append(line + ":" if opens and following.startswith("    ") and lines[number + 1] == "" else line)
    return done + (list_table(table) if table else [])


def setup(app):
    app.connect("autodoc-process-docstring", lambda app, what, name, obj, options, lines: _replace(lines))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _replace(lines: list[str]) -> None:
    lines[:] = to_rest(lines)
