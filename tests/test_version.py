"""One version: the package, its citation, its tag and its changelog say the same."""

import re
import subprocess
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]
VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
CHANGELOG = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def git(*arguments: str) -> list[str]:
    done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True)
    return done.stdout.split()


def test_the_version_is_a_semantic_one():
    assert re.fullmatch(r"\d+\.\d+\.\d+", VERSION)


def test_the_citation_has_the_version_of_the_package():
    assert yaml.safe_load((ROOT / "CITATION.cff").read_text())["version"] == VERSION


def test_the_changelog_begins_with_what_is_unreleased_or_with_this_version():
    assert re.findall(r"^## (\S+)", CHANGELOG, flags=re.MULTILINE)[0] in ("Unreleased", VERSION)


@pytest.mark.skipif(not git("tag", "--points-at", "HEAD", "v*"), reason="this commit is no release")
def test_a_release_has_the_tag_of_its_version_and_is_in_the_changelog():
    assert git("tag", "--points-at", "HEAD", "v*") == [f"v{VERSION}"]
    assert re.search(rf"^## {re.escape(VERSION)}\b", CHANGELOG, flags=re.MULTILINE)
