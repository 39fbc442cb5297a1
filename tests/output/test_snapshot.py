from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from pearlite_petsc.errors import SceneError
from pearlite_petsc.output.snapshot import Snapshot, read_snapshots, snapshot
from pearlite_petsc.output.xdmf import FieldMarks, FieldSeries
from tests.output import synthetic
from tests.scenes import default_scene


def series(folder: Path) -> list[Snapshot]:
    states = synthetic.growth_states(synthetic.voronoi_mesh(), 4)
    scene = default_scene(loading={"extension": 48.0})
    with FieldSeries(folder, "a", scene, 20) as writer:
        for state in states:
            writer.add(state)
    return [snapshot(state) for state in states]


def test_steps_read_back_are_the_states_that_were_written(tmp_path: Path) -> None:
    wanted = series(tmp_path)
    got = read_snapshots(tmp_path, "a")
    assert [step.cycles for step in got] == [step.cycles for step in wanted]
    for a, b in zip(got, wanted, strict=True):
        assert_allclose(a.points, b.points)
        assert_array_equal(a.triangles, b.triangles)
        assert_allclose(a.displacement, b.displacement, rtol=1e-6, atol=1e-7)
        assert_allclose(a.segments, b.segments)
        assert_allclose(a.damage, b.damage, rtol=1e-6)
        assert_array_equal(a.kind, b.kind)
        assert_array_equal(a.broken, b.broken)
        assert a.length == pytest.approx(b.length)
    (last,) = read_snapshots(tmp_path, "a", last_only=True)
    assert last.cycles == wanted[-1].cycles


def test_the_crack_length_of_a_snapshot_is_its_furthest_broken_point() -> None:
    states = synthetic.growth_states(synthetic.voronoi_mesh(), 3)
    assert [snapshot(s).length for s in states] == pytest.approx([s.crack.length for s in states])


def test_missing_and_broken_files_are_refused_with_the_name_of_the_task(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="fields of a cannot be read"):
        read_snapshots(tmp_path, "a")
    series(tmp_path)
    (tmp_path / "a_interfaces.h5").write_bytes(b"junk")
    with pytest.raises(SceneError, match="fields of a cannot be read"):
        read_snapshots(tmp_path, "a")
    (tmp_path / "a_elements.xdmf").write_text("<Xdmf>")
    with pytest.raises(SceneError, match="fields of a cannot be read"):
        read_snapshots(tmp_path, "a")


@pytest.mark.parametrize("steps", [1, 2, 3, 10])
def test_marks_leave_room_for_the_last_state(steps: int) -> None:
    marks = FieldMarks(steps, extension=60.0)
    lengths = 80.0 + np.linspace(0.0, 75.0, 500)
    kept = [length for length in lengths if marks.due(float(length))]
    assert len(kept) == steps - 1
    if steps > 1:
        assert kept[0] == 80.0
        assert_allclose(np.diff(kept), 60.0 / (steps - 1), atol=0.2)
