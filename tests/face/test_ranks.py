"""Under mpirun the face is collective: every rank has the whole crack and all results."""

import subprocess
import sys
from pathlib import Path

import pytest
from mpi4py import MPI

import pearlite_petsc as pp
from tests.docs.test_commands import environment
from tests.face.scenes import small_scene


def test_two_ranks_share_cracks_and_runs_and_each_has_the_results(tmp_path: Path) -> None:
    script = str(Path(__file__).with_name("on_two_ranks.py"))
    done = subprocess.run(
        ["mpirun", "-n", "2", sys.executable, script, str(tmp_path / "run")],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    lines = sorted(line.split() for line in done.stdout.splitlines() if line.startswith("rank "))
    assert [line[1] for line in lines] == ["0", "1"]
    (_, _, shared, crack, length, delta_k, own, *end), other = lines
    # Shared, the crack is the same on both ranks and in both ways of growing it.
    assert other[2:5] == [shared, crack, length]
    assert shared == crack
    assert (delta_k, other[5]) == ("18", "19")
    assert end == other[7:] == ["8", "True"]
    # And it is, but for rounding, the one that a rank grows by itself.
    assert float(shared) == pytest.approx(float(own), rel=1e-6)
    mesh = pp.build_mesh(small_scene(), "severe_AT")
    for line in lines:
        alone = pp.grow_crack(mesh, delta_k_mpa_sqrt_m=float(line[5]), comm=MPI.COMM_SELF)
        assert alone.da_dn_m_per_cycle == float(line[6])
