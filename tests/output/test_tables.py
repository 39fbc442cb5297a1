import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from pearlite_petsc.errors import SceneError
from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.output import tables
from pearlite_petsc.output.whole_file import whole_file
from tests.output import synthetic


def arrested() -> Outcome:
    return Outcome("undeformed", 0, 6e3, StopReason.ARRESTED, cycles=12.0)


def test_a_table_is_the_same_bytes_whatever_the_order_of_the_tasks(tmp_path: Path) -> None:
    tasks = synthetic.outcomes()
    states = list(synthetic.SPEED)
    tables.write_fcg(tmp_path / "a.csv", tasks, states)
    mixed = [tasks[i] for i in np.random.default_rng(0).permutation(len(tasks))]
    tables.write_fcg(tmp_path / "b.csv", mixed, states)
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


def test_rows_are_in_the_scenes_order_of_states_and_columns_are_fixed(tmp_path: Path) -> None:
    tables.write_fcg(tmp_path / "fcg.csv", synthetic.outcomes(meshes=1), ["severe_TA"])
    lines = (tmp_path / "fcg.csv").read_text().splitlines()
    assert lines[0] == (
        "state,mesh,delta_k_mpa_sqrt_m,da_dn_m_per_cycle,cycles,extension_um,tortuosity,"
        "stop_reason,solves,wall_s"
    )
    assert lines[1].startswith("severe_TA,0,8.0,")
    assert [line.split(",")[2] for line in lines[1:5]] == ["8.0", "12.0", "18.0", "25.0"]


def test_rates_are_in_metres_and_nothing_is_lost_on_the_way_back(tmp_path: Path) -> None:
    tasks = [*synthetic.outcomes(meshes=1), arrested()]
    tables.write_fcg(tmp_path / "fcg.csv", tasks, list(synthetic.SPEED))
    text = (tmp_path / "fcg.csv").read_text()
    assert "undeformed,0,6.0,nan,12.0,0.0,,arrested,0,0.0" in text
    back = tables.read_fcg(tmp_path / "fcg.csv")
    wanted = tables.in_order(tasks, list(synthetic.SPEED))
    for got, task in zip(back, wanted, strict=True):
        assert (got.state, got.mesh_index, got.stop_reason) == (
            task.state,
            task.mesh_index,
            task.stop_reason,
        )
        assert got.delta_k == task.delta_k
        assert got.tortuosity == task.tortuosity
        assert got.cycles == task.cycles
        assert got.effort.wall_s == task.effort.wall_s
        np.testing.assert_allclose(got.da_dn, task.da_dn, rtol=1e-15)
    row = next(line for line in text.splitlines() if line.startswith("severe_AT,0,18.0"))
    task = next(o for o in tasks if o.state == "severe_AT" and o.delta_k == 18e3)
    assert math.isclose(float(row.split(",")[3]) * 1e6, task.da_dn, rel_tol=1e-15)


@pytest.mark.parametrize("value", [0.3, 8.1, 12.7, 17.77, 0.1 + 0.2])
def test_a_delta_k_comes_back_as_it_was_written_in_the_scene(value: float) -> None:
    shown = tables.delta_k_in_mpa_sqrt_m(value * 1000.0)
    assert repr(shown) == repr(float(f"{value:.14g}"))


def test_names_of_tasks_show_the_delta_k_in_mpa_sqrt_m() -> None:
    assert tables.task_name("severe_AT", 2, 12_500.0) == "severe_AT_m2_dk12.5"
    assert tables.task_name("undeformed", 0, 8_000.0) == "undeformed_m0_dk8"


def test_a_history_comes_back_bit_for_bit(tmp_path: Path) -> None:
    task = synthetic.outcomes(meshes=1)[0]
    path = tables.write_growth(tmp_path / "growth", task)
    assert path == tmp_path / "growth" / "undeformed_m0_dk8.csv"
    assert path.read_text().startswith(
        "cycles,crack_length_um,path_length_um,broken_interfaces,"
        "k_1_over_delta_k,k_2_over_delta_k,k_misfit\n"
    )
    np.testing.assert_array_equal(tables.read_growth(path), task.history)
    assert tables.write_growth(tmp_path, dataclasses.replace(task, history=None)) is None


@pytest.mark.parametrize(
    "text", ["", "state,mesh\nundeformed,x\n", "junk\n1\n", "a" * 200_000 + "\n\x00,1\n"]
)
def test_a_foreign_file_is_refused_with_its_name(tmp_path: Path, text: str) -> None:
    path = tmp_path / "fcg.csv"
    path.write_text(text)
    if text:
        with pytest.raises(SceneError, match=r"fcg\.csv"):
            tables.read_fcg(path)
    else:
        assert tables.read_fcg(path) == []
    with pytest.raises(SceneError, match=r"missing\.csv"):
        tables.read_fcg(tmp_path / "missing.csv")


def test_an_interrupted_write_leaves_the_old_file_and_no_partial_one(tmp_path: Path) -> None:
    path = tmp_path / "fcg.csv"
    path.write_text("old")

    def interrupted() -> None:
        with whole_file(path) as partial:
            partial.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]
