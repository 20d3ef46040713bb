"""Checks that every link inside a built site leads to a page, and to a place on it.

`python docs/check_links.py FOLDER` prints the dead ones. Links to other sites are not followed.
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """The places of a page that links can name, and what the page links to or shows."""

    def __init__(self, file: Path):
        super().__init__()
        self.places: set[str] = {""}
        self.targets: list[str] = []
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.places.update(found[name] for name in ("id", "name") if found.get(name))
        self.targets += [found[name] for name in ("href", "src") if found.get(name)]


def dead_links(site: Path) -> list[str]:
    """Each dead link, as page and target."""
    pages = {file.resolve(): Page(file) for file in site.rglob("*.html")}
    dead = []
    for file, page in pages.items():
        for target in page.targets:
            parts = urlsplit(target)
            if parts.scheme or parts.netloc:
                continue
            aim = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            place = unquote(parts.fragment)
            if not aim.is_file() or (aim in pages and place not in pages[aim].places):
                dead.append(f"{file.relative_to(site.resolve())}: {target}")
    return dead


def main(site: str) -> None:
    dead = dead_links(Path(site))
    sys.exit("\n".join(["dead links:", *dead]) if dead else 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
