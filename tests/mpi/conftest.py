from pathlib import Path

import pytest

from tests.mpi.launch import ROOT, run


@pytest.fixture(scope="package")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a run on one rank that nobody disturbed."""
    folder = tmp_path_factory.mktemp("reference")
    done = run(1, folder)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture(scope="package")
def reference_of_quickstart(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the quickstart, without figures, that nobody disturbed."""
    folder = tmp_path_factory.mktemp("quickstart")
    scene = (ROOT / "runs" / "quickstart.toml").read_text()
    (folder / "small.toml").write_text(scene.replace("figures = true", "figures = false"))
    done = run(2, folder)
    assert done.returncode == 0, done.stderr
    assert not (folder / "out" / "figures").exists()
    return folder


@pytest.fixture(scope="package")
def reference_of_pairs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a run of which two ranks shared each task and a third was left over."""
    folder = tmp_path_factory.mktemp("pairs")
    done = run(3, folder, "--ranks-per-task", 2)
    assert done.returncode == 0, done.stderr
    assert "6 tasks on 3 rank(s), 2 a task (1 left over)" in done.stdout
    return folder
