"""A headless Chromium that tests drive, and what is wrong with the pages that it shows."""

import atexit
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import pytest

from drakearm.replay.film import BROWSER_OPTIONS, find_chromium

CHROMIUM = find_chromium()
needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed: expected chromium in the PATH")
PICTURES = Path(__file__).parents[1] / "build" / "screenshots"  # kept, to be looked at


class Visit:
    """An open page, with the errors in its console and its requests to other places."""

    def __init__(self, page):
        self.page, self.errors, self.requests = page, [], []
        page.on("console", lambda message: self.errors.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on("request", lambda request: self.requests.append(request.url))

    def picture(self, name: str) -> Path:
        PICTURES.mkdir(parents=True, exist_ok=True)
        file = PICTURES / f"{name}.png"
        self.page.screenshot(path=file)
        return file


@cache
def _browser():
    """One browser for all tests of a process, which ends with it."""
    from playwright.sync_api import sync_playwright

    playwright = sync_playwright().start()
    atexit.register(playwright.stop)
    browser = playwright.chromium.launch(executable_path=CHROMIUM, args=BROWSER_OPTIONS)
    atexit.register(browser.close)
    return browser


@contextmanager
def visit(address: str, width: int = 1280, height: int = 800, **options) -> Iterator[Visit]:
    """Opens a page in a window of this size. options: of Playwright's new_page."""
    page = _browser().new_page(viewport={"width": width, "height": height}, **options)
    page.set_default_timeout(120_000)
    visited = Visit(page)
    page.goto(address)
    yield visited
    page.close()
