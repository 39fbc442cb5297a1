"""The Dockerfile as text: what it copies exists, nobody is root, there is one list of packages."""

import json
import os
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.setup.conftest import ROOT
from tests.setup.dockerfile import chain, copied, stages

STAGES = stages((ROOT / "Dockerfile").read_text())
IGNORED = (ROOT / ".dockerignore").read_text().split()


def instructions(stage: str, word: str) -> list[str]:
    return [rest for s in chain(STAGES, stage) for w, rest in s.instructions if w == word]


def test_stages_are_base_test_and_app_and_app_is_what_a_plain_build_gives() -> None:
    assert set(STAGES) == {"base", "app", "test"}
    assert list(STAGES)[-1] == "app"
    assert STAGES["app"].start == STAGES["test"].start == "base"
    assert STAGES["base"].start == "debian:${DEBIAN}-slim"


@pytest.mark.parametrize("stage", ["app", "test"])
def test_everything_copied_exists_and_is_not_ignored(stage: str) -> None:
    for line in instructions(stage, "COPY"):
        *sources, _ = [word for word in shlex.split(line) if not word.startswith("--")]
        for source in sources:
            assert list(copied(source, IGNORED)), source


def test_results_caches_and_history_stay_outside() -> None:
    names = [str(name) for name in copied(".", IGNORED)]
    assert "pearlite.sh" in names
    assert "runs/quickstart.toml" in names
    for name in names:
        assert not name.startswith((".git/", ".venv/", "build/"))
        assert "__pycache__" not in name
        assert not name.startswith("runs/") or name.count("/") == 1


@pytest.mark.parametrize("stage", ["app", "test"])
def test_no_stage_that_is_run_is_root(stage: str) -> None:
    assert instructions(stage, "USER")[-1] not in ("root", "0")


def test_packages_come_from_the_set_up_script_alone() -> None:
    runs = " ".join(instructions("app", "RUN") + instructions("test", "RUN"))
    assert "./pearlite.sh setup" in runs
    assert "apt-get install" not in runs
    assert "pip" not in runs


def test_container_alone_runs_the_quickstart_into_work() -> None:
    assert json.loads(instructions("app", "ENTRYPOINT")[-1]) == ["/opt/pearlite/pearlite.sh"]
    command = json.loads(instructions("app", "CMD")[-1])
    assert command[0] == "run"
    assert command[1] == "/opt/pearlite/runs/quickstart.toml"
    assert command[command.index("--output") + 1].startswith("/work/")
    assert instructions("app", "WORKDIR")[-1] == "/work"


@pytest.fixture(scope="module")
def storage(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where both stages of a release find its minimal root."""
    return tmp_path_factory.mktemp("images")


@pytest.mark.slow
@pytest.mark.parametrize("stage", ["app", "test"])
@pytest.mark.parametrize("release", ["trixie", "bookworm"])
def test_the_image_is_built_and_run_without_an_engine(
    release: str, stage: str, storage: Path
) -> None:
    if os.geteuid() != 0 or not (shutil.which("buildah") and shutil.which("debootstrap")):
        pytest.skip("needs root, buildah and debootstrap")
    # Of all checks a short part: the rest does not depend on the image.
    part = ["tests/mechanics"] if stage == "test" else []
    done = subprocess.run(
        [str(ROOT / "tests" / "setup" / "container.sh"), release, stage, *part],
        env={**os.environ, "CONTAINER_STORAGE": str(storage)},
        capture_output=True,
        text=True,
        timeout=3600,
    )
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    if stage == "app":
        assert "5 rows in fcg.csv" in done.stdout
        size, unit = re.findall(r"built in .* s, ([0-9.]+) (\S+)", done.stdout)[0]
        assert unit == "MB", f"{size} {unit}"
    else:
        assert " passed" in done.stdout
