"""The benchmark command in its quick forms: tables and pictures appear, and say what they should."""

import csv
from pathlib import Path

import numpy as np
import pytest

from pearlite_petsc.bench import SUBCOMMANDS, main
from pearlite_petsc.config import load_scene, load_scene_text
from pearlite_petsc.studies.benchmarks.campaign import BASELINE, new_hierarchies, sample
from pearlite_petsc.studies.benchmarks.cracks import Plan, grow
from pearlite_petsc.studies.benchmarks.jumps import DEFAULT
from pearlite_petsc.studies.benchmarks.solver import bars, shortest


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_pareto_finds_small_blocks_more_accurate(tmp_path: Path) -> None:
    assert main(["pareto", "--quick", "--output", str(tmp_path)]) in (0, 1)
    found = {row["name"]: row for row in rows(tmp_path / "pareto.csv")}
    assert float(found["reference"]["error_shown"]) == 0.0
    assert 0.0 < float(found["default"]["error"]) < 0.15
    assert abs(float(found["compliance 0.5"]["bias"])) < abs(float(found["default"]["bias"]))
    most = float(found["default"]["solves_per_break"])
    assert float(found["reference"]["solves_per_break"]) > 5.0 * most
    assert (tmp_path / "pareto.png").stat().st_size > 10_000


def test_means_lie_in_the_intervals_of_the_reference(tmp_path: Path) -> None:
    assert main(["means", "--quick", "--output", str(tmp_path)]) == 0
    for row in rows(tmp_path / "means.csv"):
        low, mean, high = (float(row[f"reference{end}"]) for end in ("_low", "", "_high"))
        assert low < float(row["default"]) < high
        assert float(row["ratio"]) == pytest.approx(float(row["default"]) / mean, rel=1e-5)
        flipped = row["flipped"].count("(")
        assert int(row["same_path"]) + flipped == int(row["meshes"]) == 3


def test_no_mesh_of_a_few_fails_and_a_second_call_makes_none_again(tmp_path: Path) -> None:
    assert main(["meshes", "--quick", "--output", str(tmp_path)]) == 0
    found = rows(tmp_path / "meshes.csv")
    assert [row["meshes"] for row in found] == ["3"] * 5
    assert all(row["failed"] == "0" and float(row["notch_error_um"]) < 8.0 for row in found)
    assert main(["meshes", "--quick", "--output", str(tmp_path)]) == 0
    assert rows(tmp_path / "meshes.csv") == found


def test_stability_knows_where_moduli_and_k_go_wrong(tmp_path: Path) -> None:
    only = ["--only", "shears", "--only", "residual_stiffnesses"]
    assert main(["stability", "--quick", *only, "--output", str(tmp_path)]) == 0
    found = {(row["study"], row["value"]): row for row in rows(tmp_path / "stability.csv")}
    assert all(
        row["outcome"] == "converges" for (study, _), row in found.items() if "remesh" in study
    )
    assert found["gamma, affine", "100"]["outcome"] == "wrong or crashes"
    assert float(found["gamma, remesh", "100"]["error"]) == pytest.approx(0.0, abs=0.01)
    residual = "residual stiffness (emulated)"
    assert float(found[residual, "0"]["error"]) == pytest.approx(0.0, abs=1e-12)
    assert float(found[residual, "0.01"]["error"]) < -0.1
    assert (tmp_path / "stability.png").exists()


def test_raje_springs_are_refused_from_a_third_on_and_wrong_before(tmp_path: Path) -> None:
    main(["stability", "--quick", "--only", "poisson_ratios", "--output", str(tmp_path)])
    found = {(row["study"], row["value"]): row for row in rows(tmp_path / "stability.csv")}
    assert found["nu, raje", "0.4"]["outcome"] == "stops with a reason"
    assert "poisson_ratio" in found["nu, raje", "0.4"]["reason"]
    assert float(found["nu, raje", "0"]["error"]) == pytest.approx(0.0, abs=1e-6)


def test_jumps_of_a_whole_break_take_one_solve_a_break(tmp_path: Path) -> None:
    main(["jumps", "--quick", "--output", str(tmp_path)])
    found = {(row["method"], row["step"]): row for row in rows(tmp_path / "jumps.csv")}
    assert float(found["exponential", "1"]["solves_per_break"]) == pytest.approx(1.0, abs=0.15)
    assert float(found["compliance", "0.9"]["error"]) < 0.5 * float(found["euler", "1"]["error"])


def test_k_of_finite_elements_and_square_cells_comes_closer_with_width(tmp_path: Path) -> None:
    pytest.importorskip("skfem")
    assert main(["lefm", "--quick", "--output", str(tmp_path)]) == 0
    error: dict[str, list[float]] = {}
    for row in rows(tmp_path / "lefm.csv"):
        error.setdefault(row["series"], []).append(float(row["rms_error"]))
    for series in (
        "homogeneous, square cells",
        "finite elements, linear",
        "finite elements, quadratic",
    ):
        coarse, fine = error[series]
        # First order in the width for all: the tip's singularity rules the quadratic ones too.
        assert np.log2(coarse / fine) == pytest.approx(1.0, abs=0.2)
    assert error["finite elements, quadratic"][1] < 0.5 * error["finite elements, linear"][1]


def test_solvers_are_measured_on_the_intact_and_the_cracked_body_on_one_and_two_ranks(
    tmp_path: Path,
) -> None:
    chosen = ["--method", "default", "--method", "GAMG"]
    assert main(["solver", "--quick", *chosen, "--output", str(tmp_path)]) == 0
    found = rows(tmp_path / "solver.csv")
    assert {(row["method"], row["ranks"], row["crack"]) for row in found} == {
        (method, ranks, crack)
        for method, ranks in (("default", "1"), ("default", "2"), ("GAMG", "1"))
        for crack in ("none", "half")
    }
    for row in found:
        assert 0.0 < float(row["residual"]) <= 1e-8, row
        assert 0 < int(row["iterations"]) < 100
        assert float(row["solution_s"]) == pytest.approx(
            float(row["setup_s"]) + float(row["first_solve_s"]), rel=1e-4
        )
        assert float(row["memory_mib_per_rank"]) > 20.0
    alone, pair = (row for row in found if (row["method"], row["crack"]) == ("default", "none"))
    assert abs(int(alone["iterations"]) - int(pair["iterations"])) <= 5
    assert (tmp_path / "solver.png").stat().st_size > 10_000


def test_bars_of_the_solver_are_missed_by_what_is_slower_than_others() -> None:
    row = {
        "method": "default",
        "unknowns": 100_000,
        "crack": "none",
        "ranks": 1,
        "iterations": 21,
        "warm_solve_s": 0.1,
        "solution_s": 1.0,
        "memory_mib_per_rank": 100.0,
    }
    other = row | {"method": "MUMPS", "solution_s": 0.5}
    pair = row | {"ranks": 2, "solution_s": 0.7, "memory_mib_per_rank": 60.0}
    found = {text.split(",")[0]: value / most for text, value, most in bars([row, other, pair])}
    assert found["iterations"] == pytest.approx(1.05)
    assert found["warm solve [ms per 1"] == pytest.approx(0.5)
    assert found["time to solution over that of MUMPS"] == pytest.approx(2.0)
    assert found["memory of a rank over that of one alone"] == pytest.approx(0.6)


def test_the_shortest_of_each_part_of_the_rounds_counts() -> None:
    slow = {"setup_s": 1.0, "first_solve_s": 3.0, "solution_s": 4.0, "warm_solve_s": 0.1}
    fast = {"setup_s": 2.0, "first_solve_s": 1.0, "solution_s": 3.0, "warm_solve_s": 0.2}
    best = {"setup_s": 1.0, "first_solve_s": 1.0, "solution_s": 2.0, "warm_solve_s": 0.1}
    assert shortest([slow, fast]) == best


def test_sample_of_the_campaign_spreads_over_states_and_loads() -> None:
    scene = load_scene(Path(__file__).parents[3] / "runs" / "paper.toml")
    plans = [plan for _, plan in sample(scene, 8)]
    assert len({plan.delta_k for plan in plans}) == 8
    assert {plan.states for plan in plans} == {(state.name,) for state in scene.states}


def test_memory_is_that_of_the_rank_that_grew_the_meshes(tmp_path: Path) -> None:
    assert main(["memory", "--quick", "--output", str(tmp_path)]) == 0
    few, more = rows(tmp_path / "memory.csv")
    assert (few["meshes"], more["meshes"]) == ("2", "10")
    assert few["failed"] == more["failed"] == "0"
    assert 80.0 < float(few["memory_mb"]) < 400.0


def test_benchmark_that_does_not_exist_is_bad_input() -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["nothing"])
    assert stopped.value.code == 2


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["solver", "--unknowns", "-5"], "--unknowns -5 must be a number of at least 1000"),
        (["solver", "--unknowns", "inf"], "--unknowns inf must be a number of at least 1000"),
        (["means", "--meshes", "0"], "--meshes 0 must be a number of at least 1"),
        (["campaign", "--ranks", "0"], "--ranks 0 must be a number of at least 1"),
    ],
)
def test_numbers_that_mean_nothing_are_refused(
    arguments: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*arguments, "--output", str(tmp_path / "new")]) == 2
    assert capsys.readouterr().err == said + "\n"
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("name", SUBCOMMANDS)
def test_an_output_that_is_a_file_is_refused_before_anything_is_measured(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "file"
    file.write_text("kept")
    assert main([name, "--output", str(file)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err == f"{file}: cannot be used as output (File exists); choose another with --output\n"
    assert file.read_text() == "kept"


def test_the_baseline_of_the_campaign_makes_a_hierarchy_for_every_solve() -> None:
    plan = Plan(("severe_AT",), (0,), (20.0,), ("loading.extension_um=5",))
    blocks = tuple(text for text in BASELINE if "refinement" not in text)
    (once,) = grow(plan, blocks).values()
    with new_hierarchies():
        (always,) = grow(plan, blocks).values()
    (again,) = grow(plan, blocks).values()
    assert once.outcome is not None and always.outcome is not None and again.outcome is not None
    assert always.outcome.effort.counters["setups"] >= always.outcome.effort.solves
    assert always.outcome.effort.solves > once.outcome.effort.counters["setups"]
    assert again.outcome.effort.counters == once.outcome.effort.counters
    assert always.outcome.da_dn == pytest.approx(once.outcome.da_dn, rel=1e-6)


def test_the_jump_that_the_chart_marks_is_the_default() -> None:
    jump = load_scene_text("", "test").cycle_jump
    assert (jump.method.name, jump.delta_d) == DEFAULT
