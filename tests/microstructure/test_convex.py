import numpy as np
import shapely

from pearlite_petsc.microstructure.convex import Polygons


def regular(corners: int, radius: float, centre: tuple[float, float]) -> Polygons:
    angle = 2 * np.pi * np.arange(corners) / corners
    points = np.stack([np.cos(angle), np.sin(angle)], axis=1) * radius + centre
    return Polygons(points[None], np.array([corners]))


def test_area_of_a_regular_polygon_is_the_closed_form() -> None:
    area = regular(7, 3.0, (1e3, -2e3)).area()[0]
    assert abs(area - 0.5 * 7 * 9.0 * np.sin(2 * np.pi / 7)) < 1e-10


def test_clipping_agrees_with_shapely() -> None:
    rng = np.random.default_rng(3)
    lower = rng.random((200, 2)) * 10
    boxes = Polygons.boxes(lower, lower + 1 + rng.random((200, 2)) * 5)
    angle = rng.random(200) * 2 * np.pi
    normal = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    offset = np.einsum("nd,nd->n", normal, lower + rng.random((200, 2)) * 4)
    clipped = boxes.clipped(normal, offset).clipped_to_box(2.0, 3.0, 8.0, 9.0)
    along = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    for i in range(200):
        foot = normal[i] * offset[i]
        half = shapely.Polygon(
            [
                foot + 99 * along[i],
                foot - 99 * along[i],
                foot - 99 * along[i] - 99 * normal[i],
                foot + 99 * along[i] - 99 * normal[i],
            ]
        )
        exact = shapely.Polygon(boxes.listed()[i]).intersection(half)
        exact = exact.intersection(shapely.box(2.0, 3.0, 8.0, 9.0))
        assert abs(exact.area - clipped.area()[i]) < 1e-10
    assert (clipped.count == 0).any()
    assert (clipped.count > 4).any()


def test_a_polygon_beyond_the_line_vanishes_and_one_before_it_stays() -> None:
    boxes = Polygons.boxes(np.array([[0.0, 0.0], [5.0, 0.0]]), np.array([[1.0, 1.0], [6.0, 1.0]]))
    clipped = boxes.clipped(np.array([[1.0, 0.0], [1.0, 0.0]]), np.array([3.0, 3.0]))
    assert clipped.count.tolist() == [4, 0]
    assert clipped.area().tolist() == [1.0, 0.0]


def test_the_pieces_on_both_sides_of_a_line_have_the_area_of_the_whole() -> None:
    whole = regular(9, 5.0, (0.3, -0.2))
    normal, offset = np.array([[0.6, 0.8]]), np.array([1.1])
    pieces = whole.clipped(normal, offset).area() + whole.clipped(-normal, -offset).area()
    assert abs(pieces[0] - whole.area()[0]) < 1e-12
