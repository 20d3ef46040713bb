"""`drakearm replay`: what its argument can be, where the page goes, and which options do not fit each other."""

import shutil

import pytest

from drakearm.experiments import RunFolder
from drakearm.experiments.catalog import POLICIES
from tests.browser import needs_chromium, visit
from tests.cli.command import drakearm, start

LIFT = POLICIES / "lift-1kg" / "policy.safetensors"


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def titles(page):
    """The titles of the scenes in a page."""
    text = page.read_text().replace("\\u003c", "<")
    return [each.split("</h1>")[0] for each in text.split("<h1>")[1:]]


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ([LIFT], ["lift-1kg"]),
        (["reaching"], ["reach: policy reaching"]),
        (["reach-000", "--policy", "static"], ["reach-000: static optimization"]),
        ([LIFT, "--compare", "static"], ["lift-1kg: policy lift-1kg", "lift-1kg: static optimization"]),
        (["reaching", "--compare", LIFT], ["lift-1kg: policy reaching", "lift-1kg: policy lift-1kg"]),
        (["lift-1kg", "--compare", "lift-2kg"], ["lift-1kg", "lift-2kg"]),
    ],
)
def test_all_that_moves_can_be_shown(here, arguments, expected):
    assert "open page/x.html" in drakearm("replay", *arguments, "--html", "page/x.html")
    assert titles(here / "page" / "x.html") == expected


def test_where_the_page_goes(run, here):
    (here / "x.html").write_text("an earlier page")
    kept = run.path("replay").read_bytes()
    assert "open x.html" in drakearm("replay", run.folder, "--html", "x.html")
    assert titles(here / "x.html") == ["tiny"] and run.path("replay").read_bytes() == kept
    assert "open runs/replay.html" in drakearm("replay", run.folder, "--compare", "static")
    assert titles(here / "runs" / "replay.html") == ["tiny: own policy", "tiny: static optimization"]


def test_the_policy_of_a_run_shows_the_movement_of_the_run(run, here):
    assert "open runs/replay.html" in drakearm("replay", run.path("policy"))
    assert titles(here / "runs" / "replay.html") == ["tiny"]


def test_a_run_without_a_policy_asks_for_one(run, here):
    planned = RunFolder(here / "planned")
    planned.folder.mkdir()
    for name in ("scenario", "plan", "plan_picture", "reference"):
        shutil.copy(run.path(name), planned.folder)
    assert "`drakearm train tiny` makes it" in drakearm("replay", planned.folder, "--html", "x.html", code=1)
    drakearm("replay", planned.folder, "--policy", "static", "--html", "x.html")


@pytest.mark.parametrize(
    ("arguments", "code", "sentence"),
    [
        (["reaching", "--out", "x"], 2, "only the run of a SCENARIO has a folder to choose"),
        (["reaching", "--policy", "static"], 2, "not a second policy"),
        (["reach-000", "--live", "--png", "x.png"], 2, "--live writes no files"),
        (["reach-000", "--port", "7000"], 2, "expected it with --live"),
        (["reach-000", "--at", "0.1"], 2, "expected it with --png"),
        (["reach-000", "--policy", "dancing"], 1, "dancing is no policy"),
        (["none.safetensors"], 1, "There is no policy file"),
    ],
)
def test_what_does_not_fit_is_refused(here, arguments, code, sentence):
    assert sentence in " ".join(drakearm("replay", *arguments, code=code).replace("│", " ").split())
    assert list(here.iterdir()) == []


def test_the_folder_of_a_run_is_not_chosen_again(run):
    assert "only the run of a SCENARIO" in drakearm("replay", run.folder, "--out", "x", code=2)


@pytest.mark.slow
@needs_chromium
def test_a_comparison_is_pictured(here):
    printed = drakearm("replay", LIFT, "--compare", "static", "--png", "x.png")
    assert "picture in x.png" in printed and (here / "x.png").stat().st_size > 30_000


@pytest.mark.slow
@needs_chromium
def test_the_live_page_ends_with_its_stop_button(here):
    process = start("replay", LIFT, "--live")
    line = process.stdout.readline()
    assert "Open Controls" in line
    with visit(line.split()[1]) as visited:
        visited.page.locator(".close-button", has_text="Open Controls").last.click()
        visited.page.locator("li.cr.function", has_text="stop").click()
        assert process.wait(120) == 0, process.stderr.read()
