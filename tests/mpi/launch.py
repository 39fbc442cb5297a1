"""Starts the run command on some ranks, as a user would."""

import csv
import os
import shutil
import subprocess
import sys
from operator import attrgetter
from pathlib import Path

import numpy as np

from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.output.results import read_results

ROOT = Path(__file__).parents[2]
RUN = (sys.executable, "-m", "pearlite_petsc.run")
FAULTY = (sys.executable, str(Path(__file__).with_name("faulty_run.py")))
SECONDS = 600

SCENE = """
name = "small"
[microstructure]
prior_austenite_grain_um = 30.0
block_um = 20.0
colony_um = 10.0
[window]
width_um = 80.0
height_um = 80.0
notch_um = 25.0
[elements]
width_um = 2.5
length_um = 5.0
radius_um = 15.0
[states.undeformed]
[states.severe_AT]
[states.moderate_TA]
[loading]
delta_k_mpa_sqrt_m = [10.0, 18.0]
extension_um = 20.0
[solver]
relative_tolerance = 1e-9
[ensemble]
meshes = 1
[output]
field_steps = 5
figures = false
"""


def environment() -> dict[str, str]:
    paths = [str(ROOT), os.environ.get("PYTHONPATH", "")]
    return {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(path for path in paths if path),
        "OMP_NUM_THREADS": "1",
        # More ranks than cores; each name is of one version of Open MPI.
        "OMPI_MCA_rmaps_base_oversubscribe": "1",
        "OMPI_MCA_mpi_yield_when_idle": "1",
        "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    }


def command(ranks: int, program: tuple[str, ...], *arguments: object) -> list[str]:
    start = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
    return [*start, *program, *map(str, arguments)]


def start(
    ranks: int,
    folder: Path,
    *arguments: object,
    program: tuple[str, ...] = RUN,
    scene: Path | None = None,
) -> subprocess.Popen[str]:
    """Start ``program SCENE --output folder/out ARGUMENTS``, by default with folder/small.toml."""
    if scene is None:
        scene = folder / "small.toml"
        if not scene.exists():
            scene.write_text(SCENE)
    given = (scene, "--output", folder / "out", *arguments)
    return subprocess.Popen(
        command(ranks, program, *given),
        cwd=folder,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # What MPI does to its processes' group must not reach the tests.
        start_new_session=True,
    )


def run(
    ranks: int,
    folder: Path,
    *arguments: object,
    program: tuple[str, ...] = RUN,
    scene: Path | None = None,
) -> subprocess.CompletedProcess[str]:
    process = start(ranks, folder, *arguments, program=program, scene=scene)
    try:
        out, err = process.communicate(timeout=SECONDS)
    except subprocess.TimeoutExpired:
        process.kill()
        raise
    return subprocess.CompletedProcess(process.args, process.returncode, out, err)


def copy_scene(source: Path, folder: Path) -> None:
    """Let ``start`` in a folder take another folder's scene."""
    shutil.copy(source / "small.toml", folder)


def rows(folder: Path) -> list[dict[str, str]]:
    """Return the rows of ``fcg.csv`` without the wall time."""
    with (folder / "out" / "fcg.csv").open(newline="") as stream:
        table = list(csv.DictReader(stream))
    for row in table:
        assert float(row.pop("wall_s")) >= 0.0
    return table


def outcomes(folder: Path) -> tuple[Outcome, ...]:
    return read_results(folder / "out" / "results.h5").outcomes


def assert_same_cracks(folder: Path, other: Path) -> None:
    """Assert that two runs gave the same, bit for bit, wall time aside."""
    assert rows(folder) == rows(other)
    compared = 0
    for mine, theirs in zip(outcomes(folder), outcomes(other), strict=True):
        for name in ("history", "shape.path", "shape.broken_pairs"):
            values, others = map(attrgetter(name), (mine, theirs))
            assert np.array_equal(values, others), f"{mine.state} {name}"
            compared += len(values)
    assert compared > 0
