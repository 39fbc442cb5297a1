"""Films of a growing crack: frames, kinds of file, and that the crack is seen to open."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from pearlite_petsc.errors import SceneError
from pearlite_petsc.output.figures import film
from pearlite_petsc.output.snapshot import snapshot
from pearlite_petsc.scene import Kind
from tests.output import synthetic


def test_a_film_has_a_frame_for_every_step_and_rests_on_the_last(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    steps = [snapshot(s) for s in synthetic.growth_states(synthetic.voronoi_mesh(), 5)]
    path = film.animate(steps, tmp_path / "crack.gif", "test")
    with image.open(path) as frames:
        shown = sum((frames.seek(i), frames.info["duration"])[1] for i in range(frames.n_frames))
        assert frames.n_frames >= len(steps)
    assert shown == pytest.approx((len(steps) + 8) * 1000 / film.FRAMES_A_SECOND, rel=0.05)
    assert list(tmp_path.iterdir()) == [path]


def opening(path: Path) -> list[int]:
    """Return how many dark pixels the right half of each frame shows, below its title."""
    image = pytest.importorskip("PIL.Image")
    counts = []
    with image.open(path) as frames:
        for number in range(frames.n_frames):
            frames.seek(number)
            pixels = np.asarray(frames.convert("L"))
            right = pixels[len(pixels) // 5 :, int(0.52 * pixels.shape[1]) : -20]
            counts.append(int((right < 80).sum()))
    return counts


def test_in_a_film_the_crack_opens(tmp_path: Path) -> None:
    (closed,) = [snapshot(s) for s in synthetic.growth_states(synthetic.voronoi_mesh(), 1)]
    # Elements as wholes: upper ones up, lower ones down.
    ends = closed.triangles[:, [0, 1, 1, 2]].reshape(-1, 2).T
    graph = coo_matrix((np.ones(ends.shape[1]), tuple(ends)), (len(closed.points),) * 2)
    count, element = connected_components(graph, directed=False)
    height = np.bincount(element, closed.points[:, 1], count) / np.bincount(element)
    lift = np.where(height > np.median(height), 0.25, -0.25)[element]
    moved = np.column_stack([np.zeros_like(lift), lift])
    still = dataclasses.replace(closed, displacement=np.zeros_like(moved))
    path = film.animate(
        [still, dataclasses.replace(closed, displacement=moved)], tmp_path / "crack.gif", "test"
    )
    first, *_, last = opening(path)
    assert last > first + 500


def test_the_magnification_is_a_round_number_that_parts_the_faces() -> None:
    last = snapshot(synthetic.growth_states(synthetic.voronoi_mesh(), 2)[-1])
    extent = (0.0, 1e3, 0.0, 100.0)
    lift = np.zeros_like(last.displacement)
    inside = int(np.argmin(np.abs(last.points - 40.0).sum(axis=1)))
    assert film.magnification(dataclasses.replace(last, displacement=lift), extent) == 1.0
    for size, factor in ((40.0, 1.0), (1.0, 10.0), (0.2, 50.0), (0.007, 2000.0)):
        lift[inside, 1] = size
        moved = dataclasses.replace(last, displacement=lift.copy())
        assert film.magnification(moved, extent) == factor


def test_a_film_of_an_unknown_kind_or_of_nothing_is_refused(tmp_path: Path) -> None:
    steps = [snapshot(s) for s in synthetic.growth_states(synthetic.voronoi_mesh(), 2)]
    with pytest.raises(SceneError, match="at least one step"):
        film.animate([], tmp_path / "a.gif")
    with pytest.raises(SceneError, match=r"\.gif or \.mp4"):
        film.animate(steps, tmp_path / "a.avi")


def test_an_mp4_film_is_written_where_ffmpeg_is_and_refused_elsewhere(tmp_path: Path) -> None:
    steps = [snapshot(s) for s in synthetic.growth_states(synthetic.voronoi_mesh(), 2)]
    path = tmp_path / "a.mp4"
    if film.FFMpegWriter.isAvailable():
        assert b"ftyp" in film.animate(steps, path).read_bytes()[:32]
    else:
        with pytest.raises(SceneError, match="ffmpeg"):
            film.animate(steps, path)


def test_the_view_of_a_film_holds_the_whole_crack() -> None:
    last = snapshot(synthetic.growth_states(synthetic.voronoi_mesh(), 6)[-1])
    left, right, bottom, top = film.view(last)
    ends = last.segments[last.broken].reshape(-1, 2)
    assert left < last.segments[last.kind == Kind.NOTCH][..., 0].max() < right
    assert ends[:, 0].max() < right
    assert bottom < ends[:, 1].min() <= ends[:, 1].max() < top
    assert (top - bottom) >= 0.5 * (right - left) - 1e-9
