from pathlib import Path

import numpy as np
import pytest

from pearlite_petsc.bench import main
from pearlite_petsc.config import load_scene_text
from pearlite_petsc.errors import SceneError
from pearlite_petsc.fatigue.outcome import CrackShape, Outcome, StopReason
from pearlite_petsc.studies.benchmarks.widths import (
    common_rates,
    overrides_of,
    path_shares,
    summary,
)


def row(mesh: int, size: str, rate: float) -> dict[str, str]:
    shares = {"along_lamellae": "0.5", "through_cementite": "0.3", "along_boundaries": "0.2"}
    return {
        "state": "undeformed",
        "mesh": str(mesh),
        "size": size,
        "da_dn_um_per_cycle": str(rate),
        "stop_reason": "grown",
        "solves": "30",
        "broken": "20",
        **shares,
    }


def test_the_power_of_the_width_is_found_mesh_by_mesh() -> None:
    sizes = ["1x1", "2x2", "4x4"]
    rows = [
        row(mesh, size, scale * float(size[0]) ** power)
        for mesh, (scale, power) in enumerate([(0.1, 0.5), (3.0, -0.25)])
        for size in sizes
    ]
    logs, powers = common_rates([*rows, row(2, "1x1", 1.0)], "undeformed", sizes)
    assert logs.shape == (2, 3)
    assert powers == pytest.approx([0.5, -0.25], rel=1e-12)
    lines = list(summary(rows, ["undeformed"], sizes))
    assert any("p = 0.12" in line for line in lines)
    assert any("1.50 solves a break, 2 grown" in line for line in lines)


def test_a_mesh_without_a_rate_at_one_size_is_left_out() -> None:
    rows = [row(0, "1x1", 1.0), row(0, "2x2", float("nan"))]
    assert len(common_rates(rows, "undeformed", ["1x1", "2x2"])[0]) == 0


def test_a_size_that_is_none_is_refused() -> None:
    with pytest.raises(SceneError, match="2by4: not of the form 2x4"):
        overrides_of("2by4")


def test_a_path_in_one_colony_runs_along_its_lamellae_or_through_cementite() -> None:
    huge = [
        f"microstructure.{name}_um=5e4" for name in ("prior_austenite_grain", "block", "colony")
    ]
    scene = load_scene_text("", "one_colony", huge)
    for step, expected in (([1.0, 0.0], (1.0, 0.0, 0.0)), ([0.0, 1.0], (0.0, 1.0, 0.0))):
        path = np.array([80.0, 100.0]) + np.outer(np.arange(5.0), step)
        shape = CrackShape(path, np.array([[1, 2]]))
        outcome = Outcome("severe_AT", 0, 18e3, StopReason.GROWN, shape=shape)
        assert path_shares(outcome, scene, "severe_AT", 0) == pytest.approx(expected)


def test_a_second_call_goes_on_with_what_is_missing(tmp_path: Path) -> None:
    assert main(["widths", "--quick", "--output", str(tmp_path)]) == 0
    written = (tmp_path / "widths.csv").read_text(encoding="utf-8").splitlines()
    assert len(written) == 1 + 2 * 2
    (tmp_path / "widths.csv").write_text("\n".join(written[:-1]) + "\n", encoding="utf-8")
    assert main(["widths", "--quick", "--output", str(tmp_path)]) == 0
    again = (tmp_path / "widths.csv").read_text(encoding="utf-8").splitlines()
    for line, other in zip(written, again, strict=True):
        # The processor time is another.
        assert line.rsplit(",", 2)[0] == other.rsplit(",", 2)[0]
