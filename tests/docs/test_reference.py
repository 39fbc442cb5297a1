"""The reference agrees with the program."""

import argparse
import importlib
import re
import subprocess
import sys
from pathlib import Path

import h5py
import pytest

from pearlite_petsc.bench import SUBCOMMANDS
from pearlite_petsc.exit_status import ExitStatus
from pearlite_petsc.fatigue.outcome import StopReason
from pearlite_petsc.output.results import write_results
from pearlite_petsc.output.tables import FCG_COLUMNS, GROWTH_COLUMNS
from pearlite_petsc.output.xdmf import FieldSeries
from pearlite_petsc.studies.benchmarks.stability_studies import STUDIES
from tests.docs.pages import ROOT
from tests.docs.test_commands import environment
from tests.output import synthetic
from tests.scenes import default_scene

REFERENCE = (ROOT / "docs" / "reference.md").read_text(encoding="utf-8")


def names(heading: str, column: str) -> list[str]:
    """Return the first column of the table with a head, below a heading."""
    section = REFERENCE.split(f"{heading}\n", 1)[1]
    # A table begins after an empty line; rows of another may begin alike.
    rows = (
        f"\n\n{section.lstrip()}".split(f"\n\n| {column} |", 1)[1].split("\n\n")[0].splitlines()[2:]
    )
    return [re.findall(r"`([^`]+)`", row)[0] for row in rows]


LETTER = {"mesh": "i", "step": "j"}


def contents(file: h5py.File) -> set[str]:
    """Return the names of all datasets; each has a unit and a description."""
    found: dict[str, h5py.Dataset] = {}
    file.visititems(
        lambda name, item: found.update({name: item}) if hasattr(item, "dtype") else None
    )
    assert all(item.attrs["unit"] and item.attrs["description"] for item in found.values())
    return set(found)


def datasets(heading: str) -> set[str]:
    """Return the names in the first column of the table below a heading."""
    rows = REFERENCE.split(f"{heading}\n", 1)[1].split("\n#", 1)[0].splitlines()
    first = [row.split(" | ")[0] for row in rows if re.match(r"\| `(/|mesh_|step_)", row)]
    return {name for row in first for name in re.findall(r"`([^`]+)`", row)}


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
    from pearlite_petsc.output.mesh_file import _DATASETS, POLYGONS

    described = datasets("## Mesh file")
    assert described == {f"/{name}" for name, _, _ in _DATASETS.values()} | {f"/{POLYGONS}"}


def test_every_dataset_of_results_and_fields_is_described(tmp_path: Path) -> None:
    path = tmp_path / "results.h5"
    write_results(path, "", synthetic.outcomes(meshes=1)[:1], {}, "state\n")
    with h5py.File(path) as file:
        task = next(iter(file["tasks"]))
        found = {f"/{name}".replace(task, "<crack>") for name in contents(file)}
    assert datasets("### results.h5") == found
    states = synthetic.growth_states(synthetic.voronoi_mesh(), 2)
    with FieldSeries(tmp_path, "a", default_scene(), 2) as series:
        for state in states:
            series.add(state)
    found = set()
    for name in ("elements", "interfaces"):
        with h5py.File(tmp_path / f"a_{name}.h5") as file:
            found |= {
                re.sub(r"(mesh|step)_[0-9]", lambda m: f"{m[1]}_<{LETTER[m[1]]}>", n)
                for n in contents(file)
            }
    assert datasets("### fields") == found


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
