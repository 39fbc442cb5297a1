"""What is written for contributors is what the checks hold."""

import re
import tomllib

import yaml

from tests.docs.pages import ROOT
from tests.test_architecture import (
    MOST_ATTRIBUTES,
    MOST_LINES,
    MOST_LINES_OF_CODE,
    MOST_METHODS,
)

PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")


def test_the_bars_are_those_of_the_tests() -> None:
    text = " ".join(PAGE.split())
    assert (
        f"A file has at most {MOST_LINES} lines, a function {MOST_LINES_OF_CODE} lines of code, a "
        f"class {MOST_METHODS} methods and {MOST_ATTRIBUTES} attributes." in text
    )
    covered = re.search(r"--cov-fail-under=(\d+)", (ROOT / "pearlite.sh").read_text())
    assert covered is not None
    assert f"must stay at {covered[1]} % of its lines" in text


def test_commits_are_checked_by_the_same_ruff_as_the_tests() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    wanted = [name for name in project["optional-dependencies"]["dev"] if name.startswith("ruff")]
    (checks,) = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text())["repos"]
    assert checks["hooks"]
    for hook in checks["hooks"]:
        assert hook["additional_dependencies"] == wanted


def test_the_templates_for_issues_can_be_read() -> None:
    for file in (ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml"):
        content = yaml.safe_load(file.read_text())
        if file.stem != "config":
            assert {"name", "description", "body"} <= content.keys()
            assert all(item["attributes"]["label"] for item in content["body"])
