"""The run command: bad input is one message and nothing written; dry runs compute nothing."""

import importlib.util
import json
import tomllib
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pearlite_petsc import run_options
from pearlite_petsc.config import load_scene, scene_to_toml
from pearlite_petsc.output.results import write_results

run = importlib.import_module("pearlite_petsc.run")

RUNS = Path(__file__).parents[2] / "runs"
PRESET = RUNS / "quickstart.toml"
LINES = PRESET.read_text().splitlines()


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Every test runs in a folder of its own, on what looks like the first rank of one."""
    for name in ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "SLURM_PROCID"):
        monkeypatch.delenv(name, raising=False)
        monkeypatch.delenv(name.replace("RANK", "SIZE"), raising=False)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def refusal(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """Return the message of a command that must be refused before anything is written."""
    files = set(Path().rglob("*"))
    try:
        status = run.main(arguments)
    except SystemExit as left:
        status = left.code
    out, err = capsys.readouterr()
    assert status == 2
    assert out == ""
    assert err.endswith("\n")
    assert err.count("\n") == 1
    assert set(Path().rglob("*")) == files
    return err


@pytest.mark.parametrize(
    "arguments, message",
    [
        (["nothing.toml"], "nothing.toml: no such file"),
        (["--set", "elements.widht_um=3"], "widht_um is unknown, did you mean width_um?"),
        (["--set", "elements.width_um=-3"], "width_um = -3"),
        (["--set", "elements.width_um=nan"], "width_um = NaN is not a finite number"),
        (["--set", "window.notch_um=250"], "notch_um = 250"),
        (["--set", "loading.delta_k_mpa_sqrt_m=[-1]"], "delta_k_mpa_sqrt_m"),
        (["--set", "loading.delta_k_mpa_sqrt_m=[8, 8]"], "delta_k_mpa_sqrt_m"),
        (
            ["--set", "material.springs=raje", "--set", "material.poisson_ratio=0.34"],
            "poisson_ratio",
        ),
        (["--set", "output.experiment=mine.csv"], "mine.csv: measured points cannot be read"),
        (["--ranks-per-task", "0"], "ranks_per_task = 0 must be at least 1"),
        (["--ranks-per-task", "two"], "invalid int value: 'two'"),
        (["--max-walltime", "nan"], "--max-walltime nan is not a time"),
        (["--checkpoint-interval", "-1"], "--checkpoint-interval -1 is not a time"),
        (["--resume", "--overwrite"], "cannot be combined"),
        (["--retry-failed"], "needs --resume"),
        (["--frobnicate"], "unrecognized arguments: --frobnicate"),
        (["--res"], "unrecognized arguments: --res"),
        (["--", "ksp_view"], "-- ksp_view: PETSc options start with -"),
        (["results.h5"], "results.h5: no such file"),
        (["binary.h5"], "binary.h5: cannot be read as results"),
        (["."], "is a folder"),
    ],
)
def test_bad_input_is_one_message_and_nothing_is_written(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("binary.h5").write_bytes(bytes(range(256)))
    assert message in refusal(capsys, *arguments)


def test_a_measured_curve_with_a_bad_number_is_refused_before_the_run(
    capsys: pytest.CaptureFixture[str],
) -> None:
    Path("mine.csv").write_text(
        "state,delta_k_mpa_sqrt_m,da_dn_m_per_cycle\nsevere_AT,12,1e-8\nsevere_AT,18,-3\n"
    )
    message = refusal(capsys, "--set", "output.experiment=mine.csv", "--dry-run")
    assert "mine.csv: line 3: da_dn_m_per_cycle = '-3'" in message


def test_only_the_first_rank_speaks(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "1")
    assert run.main(["nothing.toml"]) == 2
    assert run.main(["--dry-run"]) == 0
    assert capsys.readouterr() == ("", "")


def test_a_dry_run_tells_scene_size_and_cost_and_writes_nothing(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    arguments = ["--dry-run", "--set", "ensemble.meshes=3", "--set", "elements.width_um=3.0"]
    assert run.main(arguments) == 0
    text = capsys.readouterr().out
    scene, _, rest = text.partition("\noutput ")
    assert tomllib.loads(scene)["elements"]["width_um"] == 3.0
    assert "tasks       60 = 5 states x 3 meshes x 4 Delta-K" in rest
    for word in ("elements ", "unknowns", "memory ", "time "):
        assert word in rest
    assert list(tmp_path.iterdir()) == []


def test_every_preset_has_a_dry_run(capsys: pytest.CaptureFixture[str]) -> None:
    presets = sorted(RUNS.glob("*.toml"))
    assert {path.stem for path in presets} >= {"quickstart", "paper", "source"}
    for path in presets:
        assert run.main([str(path), "--dry-run"]) == 0, path
        assert f"output      runs/{load_scene(path).name}" in capsys.readouterr().out


def test_the_default_scene_is_the_quickstart_with_or_without_its_file(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run.main(["--dry-run"])
    beside = capsys.readouterr().out
    assert beside.startswith(scene_to_toml(load_scene(PRESET)))
    monkeypatch.setattr("pearlite_petsc.__file__", str(tmp_path / "site" / "package" / "x.py"))
    run.main(["--dry-run"])
    assert capsys.readouterr().out == beside


def test_results_are_a_scene(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    scene = load_scene(PRESET, ["elements.width_um=2.5"])
    write_results(tmp_path / "old.h5", scene_to_toml(scene), [], {})
    assert run.main(["old.h5", "--dry-run", "--set", "ensemble.meshes=2"]) == 0
    tables = tomllib.loads(capsys.readouterr().out.partition("\noutput ")[0])
    assert tables["name"] == "quickstart"
    assert tables["elements"]["width_um"] == 2.5
    assert tables["ensemble"]["meshes"] == 2


def test_the_schema_is_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert run.main(["--schema"]) == 0
    assert "microstructure" in json.loads(capsys.readouterr().out)["properties"]


def test_help_tells_units_examples_and_exit_status(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        run.main(["--help"])
    assert left.value.code == 0
    text = capsys.readouterr().out
    for word in ("MPa sqrt(m)", "mpirun -n 2", "-ksp_type", "130", "--retry-failed"):
        assert word in text


VALUES = st.one_of(
    st.floats().map(repr),
    st.integers(-(10**40), 10**40).map(str),
    st.sampled_from(["true", '""', '"two"', "[]", "[[]]", "nan", "-inf", "1e400", "[nan]", "= 3"]),
    st.lists(st.floats(0.1, 100.0), max_size=4).map(str),
    st.text(max_size=12),
)
CHANGES = st.lists(st.tuples(st.sampled_from(range(len(LINES))), VALUES), min_size=1, max_size=3)
TRUNCATED = st.tuples(st.integers(0, len(PRESET.read_bytes())), st.binary(max_size=20)).map(
    lambda cut: PRESET.read_bytes()[: cut[0]] + cut[1]
)
CONTENTS = st.one_of(st.binary(max_size=200), TRUNCATED)
MANY = settings(
    max_examples=250,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
    derandomize=True,
)


@MANY
@given(changes=CHANGES)
def test_a_mutated_scene_is_one_message_or_a_dry_run(
    changes: list[tuple[int, str]], elsewhere: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = list(LINES)
    for number, value in changes:
        name, equals, _ = lines[number].partition("=")
        lines[number] = f"{name}= {value}" if equals else value
    one_message_or_dry_run("\n".join(lines).encode("utf-8", "surrogatepass"), elsewhere, capsys)


@MANY
@given(content=CONTENTS)
def test_a_broken_file_is_one_message_or_a_dry_run(
    content: bytes, elsewhere: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one_message_or_dry_run(content, elsewhere, capsys)


def one_message_or_dry_run(
    content: bytes, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "scene.toml").write_bytes(content)
    status = run.main(["scene.toml", "--dry-run"])
    out, err = capsys.readouterr()
    assert [path.name for path in folder.iterdir()] == ["scene.toml"]
    if status == 0:
        assert err == ""
        assert "\ntime " in out
    else:
        assert status == 2
        assert out == ""
        assert err.count("\n") == 1
        assert "scene.toml" in err or "measured points" in err


@pytest.mark.parametrize("rank", ["0", "1"])
@pytest.mark.parametrize("option", ["--help", "--version", "--schema"])
def test_what_needs_no_run_is_said_by_the_first_rank_alone(
    rank: str, option: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", rank)
    with suppress(SystemExit):
        assert run.main([option]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert bool(out) == (rank == "0")


def test_the_examples_of_the_help_use_scenes_that_everybody_has() -> None:
    named = {word for word in run_options._EXAMPLES.split() if word.endswith(".toml")}
    assert named
    for name in named:
        assert (RUNS.parent / name).is_file(), name


@pytest.mark.parametrize(
    "arguments, message",
    [
        (["--ranks", "0"], "--ranks 0 is not a positive whole number"),
        (["--ranks", "two"], "invalid int value: 'two'"),
        (["--ranks", "2", "--ranks-per-task", "3"], "is more than the 2 rank(s) of this run"),
        (["--ranks", "2", "--output", "other"], "other: exists and was not made by"),
        (["--ranks", "2", "--output", "file"], "file: is a file; --output needs a folder"),
    ],
)
def test_the_launcher_refuses_what_the_ranks_would(
    arguments: list[str],
    message: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(run, "launch_run", lambda *given: pytest.fail("started"))
    Path("other").mkdir()
    Path("other/mine.txt").write_text("mine")
    Path("file").write_text("")
    assert message in refusal(capsys, *arguments)


def test_a_folder_that_cannot_be_written_names_the_option(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("os.access", lambda path, mode: False)
    monkeypatch.setattr(run, "launch_run", lambda *given: pytest.fail("started"))
    message = refusal(capsys, "--ranks", "2", "--output", "deep/inside")
    assert message.startswith("deep/inside: cannot be used as output (")
    assert "choose another with --output" in message


@pytest.mark.parametrize(
    "ranks, names", [([], ("petsc4py",)), (["--ranks", "2"], ("mpi4py", "petsc4py"))]
)
def test_missing_modules_are_one_line_with_what_helps(
    ranks: list[str],
    names: tuple[str, ...],
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = importlib.util.find_spec

    def find(name: str) -> object:
        return None if name in names else found(name)

    monkeypatch.setattr("importlib.util.find_spec", find)
    assert run.main(ranks) == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert err.startswith(f"{' and '.join(names)} cannot be found by ")
    assert ". .venv/bin/activate" in err


def test_a_missing_mpirun_is_one_line(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    assert run.main(["--ranks", "2"]) == 1
    assert capsys.readouterr().err.count("mpirun is not found") == 1
