"""What a run refuses once MPI is there."""

import shutil
from pathlib import Path

from tests.mpi.launch import assert_same_cracks, run


def test_two_ranks_complain_once_and_write_nothing(tmp_path: Path) -> None:
    done = run(2, tmp_path, "--set", "elements.widht_um=3")
    assert done.returncode == 2
    assert done.stderr.count("did you mean width_um?") == 1
    assert "Traceback" not in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["small.toml"]


def test_a_finished_folder_is_refused_without_a_word_what_to_do_with_it(
    reference: Path, tmp_path: Path
) -> None:
    shutil.copytree(reference, tmp_path, dirs_exist_ok=True)
    before = {path: path.stat().st_mtime_ns for path in (tmp_path / "out").rglob("*")}
    for arguments, message in (
        ((), "exists; --resume goes on with it, --overwrite replaces it"),
        (("--resume", "--set", "microstructure.seed=2"), "[microstructure] seed: 1, now 2"),
        (("--ranks-per-task", 2), "ranks_per_task = 2 is more than the 1 rank(s) of this run"),
    ):
        done = run(1, tmp_path, *arguments)
        assert done.returncode == 2
        assert message in done.stderr
        assert done.stderr.count("\n") == 1
        assert done.stdout == ""
        after = {path: path.stat().st_mtime_ns for path in (tmp_path / "out").rglob("*")}
        assert after == before


def test_a_finished_run_that_is_resumed_computes_nothing(reference: Path, tmp_path: Path) -> None:
    shutil.copytree(reference, tmp_path, dirs_exist_ok=True)
    finished = sorted((tmp_path / "out" / "checkpoint" / "finished").iterdir())
    before = [path.stat().st_mtime_ns for path in finished]
    made = [tmp_path / "out" / name for name in ("report.html", "provenance.json", "results.h5")]
    made[0].write_text("drawn by the run before")
    was = [path.read_bytes() for path in made]
    done = run(1, tmp_path, "--resume")
    assert done.returncode == 0, done.stderr
    assert "6 of 6 tasks done" in done.stdout
    # Nor does it claim the cracks, and the time that they took, for itself.
    assert [path.read_bytes() for path in made] == was
    assert [path.stat().st_mtime_ns for path in finished] == before
    assert_same_cracks(tmp_path, reference)
    assert (tmp_path / "out" / "fcg.csv").read_bytes() == (
        reference / "out" / "fcg.csv"
    ).read_bytes()
