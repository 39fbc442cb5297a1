"""The command: what it prints and writes, and that a false claim is noticed."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("petsc4py")

from pearlite_petsc.mechanics.springs import Stiffness
from pearlite_petsc.studies.bodies import plain_mesh, random_points
from pearlite_petsc.studies.verification import exact, fracture, series_spring, suite
from pearlite_petsc.studies.verification.claim import Section, Setting, fitted_order, number
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.verify import main

SMALL = plain_mesh(random_points(60, 8.0, 8.0, seed=1), 8.0, 8.0)


def one_claim(holds: bool) -> dict[str, object]:
    def section(setting: Setting) -> Section:
        (setting.folder / "made.png").write_bytes(b"x")
        made = Section("A title", figures={"made": "A caption."})
        made.close("a|b", "Eq. (1)", 1.0, 1.0 if holds else 1.2, 0.1)
        made.table(["head"], [["cell"]])
        return made

    return {"one": section, "two": section}


@pytest.mark.parametrize(("holds", "status"), [(True, 0), (False, 1)])
def test_a_claim_that_does_not_hold_is_the_exit_status(
    holds: bool,
    status: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(suite, "SECTIONS", one_claim(holds))
    assert main(["--quick", "--output", str(tmp_path / "new")]) == status
    printed = capsys.readouterr().out
    assert ("pass  a|b" in printed) == holds and ("FAIL  a|b" in printed) != holds
    report = (tmp_path / "new" / "report.md").read_text()
    assert ("**no**" in report) != holds
    assert r"a\|b" in report and "![A caption.](made.png)" in report and "| cell |" in report
    assert f"Claims: 2, of which {0 if holds else 2} do not hold" in report


def test_one_section_alone_can_be_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(suite, "SECTIONS", one_claim(True))
    assert main(["--only", "two", "--output", str(tmp_path)]) == 0
    assert "1 claims" in capsys.readouterr().out


def test_what_could_not_be_compared_is_said_at_the_end_and_in_the_report(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def missing(*_: object) -> tuple[int, float]:
        raise ImportError

    monkeypatch.setattr(fracture, "finite_element_ratio", missing)
    assert main(["--quick", "--only", "fracture", "--output", str(tmp_path)]) == 0
    said = "left out: K of 5 bodies against linear finite elements: scikit-fem is not installed"
    assert capsys.readouterr().out.splitlines()[-1].startswith(said)
    report = (tmp_path / "report.md").read_text()
    assert f"- {said}" in report
    assert "FE K ratio" not in report and "triangles" not in report


def test_an_unknown_section_is_refused_with_the_known_ones(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["--only", "fractur", "--output", str(tmp_path / "new")]) == 2
    assert "fracture" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


def test_an_output_that_is_a_file_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "file"
    file.write_text("kept")
    assert main(["--quick", "--output", str(file)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err == f"{file}: cannot be used as output (File exists); choose another with --output\n"
    assert file.read_text() == "kept"


def test_numbers_at_and_off_their_tolerance_and_nan() -> None:
    section = Section("")
    section.close("", "", 1.0, 1.5, 0.5)
    section.close("", "", 1.0, 1.5001, 0.5)
    section.close("", "", 1.0, float("nan"), 0.5)
    section.below("", "", 1e-9, 1e-9)
    section.below("", "", float("nan"), 1e-9)
    section.above("", "", 2.0, 1.5)
    section.above("", "", float("nan"), 1.5)
    assert [claim.holds for claim in section.claims] == [
        True,
        False,
        False,
        True,
        False,
        True,
        False,
    ]
    assert [number(value) for value in (0.0, 1.5, 2e-5, 12345.0)] == [
        "0",
        "1.5",
        "2.0e-05",
        "1.234e+04",
    ]


def test_a_power_law_has_its_order() -> None:
    sizes = [1.0, 2.0, 4.0]
    assert fitted_order(sizes, [3.0 * size**1.7 for size in sizes]) == pytest.approx(1.7)


def test_springs_that_are_one_percent_off_fail_the_patch_test(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    right = exact.spring_stiffness

    def wrong(mesh: Mesh, *rest: object) -> Stiffness:
        springs = right(mesh, *rest)  # type: ignore[arg-type]
        return Stiffness(springs.k_n, 1.01 * springs.k_t)

    assert max(exact.traction_errors(SMALL).values()) < 1e-9
    monkeypatch.setattr(exact, "spring_stiffness", wrong)
    assert max(exact.traction_errors(SMALL).values()) > 1e-3


def test_a_midpoint_off_its_facet_breaks_the_patch_test_and_the_balance_of_moments() -> None:
    moved = SMALL.midpoint.copy()
    moved += 0.01 * np.stack([-SMALL.normal[:, 1], SMALL.normal[:, 0]], axis=1)
    assert max(exact.traction_errors(replace(SMALL, midpoint=moved)).values()) > 1e-4


def test_an_affine_motion_of_a_random_mesh_is_no_hookes_law_with_the_source_springs() -> None:
    unbalanced, stress = exact.affine_errors(
        plain_mesh(random_points(200, 8.0, 8.0, seed=2), 8.0, 8.0), "raje"
    )
    assert unbalanced > 1e-2 and stress > 1e-2


def test_a_shear_weight_one_percent_off_is_no_exact_life(monkeypatch: pytest.MonkeyPatch) -> None:
    case = series_spring.SeriesSpring(3e3, 6e3, 0.5)
    right = case.jumped_life("compliance", 0.05) / case.exact_life() - 1.0
    damage = replace(series_spring.DAMAGE, beta=1.01 * series_spring.DAMAGE.beta)
    life = case.jumped_life("compliance", 0.05)
    monkeypatch.setattr(series_spring, "DAMAGE", damage)
    wrong = life / case.exact_life() - 1.0
    assert abs(right) < 2e-4 < 1e-3 < abs(wrong)
