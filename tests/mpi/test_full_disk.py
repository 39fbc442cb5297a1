"""Disks of random sizes that fill somewhere: one message, nothing lost, and the next run goes on."""

import os
import random
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.mpi.launch import ROOT, assert_same_cracks, environment, run
from tests.mpi.test_failures import assert_one_message

FIGURES = ("--set", "output.figures=true")


def mounted(folder: Path, *options: str) -> bool:
    command = ["mount", "-t", "tmpfs", "-o", ",".join(options), "tmpfs", str(folder)]
    return subprocess.run(command, capture_output=True).returncode == 0


@pytest.fixture
def disk(tmp_path: Path) -> Iterator[Path]:
    """A file system in ``out`` that the test may make smaller and larger."""
    folder = tmp_path / "out"
    folder.mkdir()
    if os.geteuid() != 0 or not mounted(folder, "size=64k"):
        pytest.skip("needs the right to mount a file system")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_a_disk_of_any_size_may_fill(
    seed: int, reference: Path, tmp_path: Path, disk: Path
) -> None:
    choice = random.Random(seed)
    size = round(8.0 * 1000.0 ** choice.random())
    assert mounted(disk, "remount", f"size={size}k")
    done = run(choice.choice([1, 2]), tmp_path, *FIGURES)
    if done.returncode == 2:
        assert "cannot be used as output (No space left on device)" in done.stderr
        assert done.stderr.count("\n") == 1
    elif done.returncode == 1:
        assert_one_message(done, "No space left on device")
    else:
        assert done.returncode == 0, done.stderr
    assert mounted(disk, "remount", "size=100m")
    done = run(1, tmp_path, *FIGURES, "--resume")
    assert done.returncode == 0, done.stderr
    assert_same_cracks(tmp_path, reference)
    assert (disk / "report.html").is_file()
    assert not list(disk.rglob("*.partial"))


def test_a_report_on_a_full_or_read_only_disk_is_one_message(
    reference: Path, tmp_path: Path, disk: Path
) -> None:
    assert mounted(disk, "remount", "size=1m")
    for name in ("results.h5", "scene.resolved.toml"):
        (disk / name).write_bytes((reference / "out" / name).read_bytes())
    free = os.statvfs(disk)
    (disk / "filler").write_bytes(bytes(free.f_bavail * free.f_bsize - 30_000))
    for remount, said in ((), "No space left on device"), (("ro",), "Read-only file system"):
        if remount:
            assert mounted(disk, "remount", *remount)
        done = run_report(disk)
        assert done.returncode == 1
        assert said in done.stderr
        lines = [line for line in done.stderr.splitlines() if "is left out" not in line]
        assert len(lines) == 1, done.stderr
        assert lines[0].startswith("the report cannot be written: ")


def run_report(folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "pearlite_petsc.report", str(folder)],
        cwd=ROOT,
        env=environment(),
        capture_output=True,
        text=True,
        timeout=300,
    )
