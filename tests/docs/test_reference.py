"""The reference agrees with the program."""

import argparse
import importlib
import re
import subprocess
import sys

import pytest

from pearlite_petsc.bench import SUBCOMMANDS
from pearlite_petsc.exit_status import ExitStatus
from pearlite_petsc.fatigue.outcome import StopReason
from pearlite_petsc.output.tables import FCG_COLUMNS, GROWTH_COLUMNS
from pearlite_petsc.studies.benchmarks.stability_studies import STUDIES
from tests.docs.pages import ROOT
from tests.docs.test_commands import environment

REFERENCE = (ROOT / "docs" / "reference.md").read_text(encoding="utf-8")


def names(heading: str, column: str) -> list[str]:
    """Return the first column of the table with a head, below a heading."""
    section = REFERENCE.split(f"{heading}\n", 1)[1]
    # A table begins after an empty line; rows of another may begin alike.
    rows = (
        f"\n\n{section.lstrip()}".split(f"\n\n| {column} |", 1)[1].split("\n\n")[0].splitlines()[2:]
    )
    return [re.findall(r"`([^`]+)`", row)[0] for row in rows]


def test_the_page_of_scene_keys_is_what_its_script_prints() -> None:
    done = subprocess.run(
        [sys.executable, str(ROOT / "docs" / "scene_keys.py")],
        env=environment(),
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    assert done.stdout == (ROOT / "docs" / "scene-keys.md").read_text(encoding="utf-8")


def test_the_columns_of_both_tables_are_described() -> None:
    assert names("### fcg.csv", "column") == list(FCG_COLUMNS)
    assert names("### growth/*.csv", "column") == list(GROWTH_COLUMNS)


def test_every_stop_reason_is_described() -> None:
    described = names("### fcg.csv", "`stop_reason`")
    assert sorted(described) == sorted(reason.value for reason in StopReason)


def test_every_dataset_of_the_mesh_file_is_described() -> None:
    from pearlite_petsc.output.mesh_file import _DATASETS

    rows = [line for line in REFERENCE.splitlines() if line.startswith("| `/")]
    described = {name for row in rows for name in re.findall(r"`/([^`]+)`", row)}
    assert described == {name for name, _, _ in _DATASETS.values()}


@pytest.mark.parametrize("name", SUBCOMMANDS)
def test_every_benchmark_is_described_with_its_options(name: str) -> None:
    section = REFERENCE.split("### bench\n")[1].split("\n## ")[0]
    rows = [line for line in section.splitlines() if line.startswith(f"| `{name}` |")]
    assert len(rows) == 1
    _, _, _, quick, options, _, _ = rows[0].split("|")
    parser = argparse.ArgumentParser(add_help=False)
    importlib.import_module(f"pearlite_petsc.studies.benchmarks.{name}").add_arguments(parser)
    known = {option for action in parser._actions for option in action.option_strings}
    assert known - {"--quick", "--output"} == set(re.findall(r"`(--[a-z]+)", options))
    assert ("--quick" in known) != quick.strip().startswith("none")


def test_every_study_of_where_methods_fail_is_named() -> None:
    row = next(line for line in REFERENCE.splitlines() if line.startswith("| `stability` |"))
    assert re.findall(r"`(\w+)`", row.split("|")[2]) == [study.__name__ for study in STUDIES]


def test_the_exit_statuses_are_those_of_the_command() -> None:
    section = REFERENCE.split("## Exit status\n")[1].split("## ")[0]
    described = {int(number) for number in re.findall(r"^\| (\d+) \|", section, re.MULTILINE)}
    assert described == set(ExitStatus)
