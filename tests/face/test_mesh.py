"""Meshes from Python: tables with units, the mesh of a run, pictures."""

import numpy as np
import pytest
from matplotlib import pyplot

import pearlite_petsc as pp
from pearlite_petsc.growth.prepared import prepare_growth
from tests.face.scenes import small_scene


def test_a_mesh_is_the_one_of_a_run_with_the_same_scene() -> None:
    scene = small_scene()
    program = scene._program
    wanted = prepare_growth(program, program.states[1], 1).mesh
    mesh = pp.build_mesh(scene, "severe_AT", index=1)
    assert (mesh.state, mesh.index) == ("severe_AT", 1)
    assert np.array_equal(mesh.vertices_um, wanted.vertices)
    assert np.array_equal(mesh.interfaces.length_um, wanted.length)
    assert mesh.notch_um == wanted.notch
    assert mesh.window_um == (80.0, 80.0)


def test_elements_fill_the_window_and_interfaces_join_them() -> None:
    mesh = pp.build_mesh(small_scene(), "undeformed")
    elements, interfaces = mesh.elements, mesh.interfaces
    assert elements.area_um2.sum() == pytest.approx(80.0 * 80.0, rel=1e-12)
    assert interfaces.i.max() < len(elements)
    assert (interfaces.i < interfaces.j).all()
    ends = mesh.vertices_um[interfaces.start], mesh.vertices_um[interfaces.end]
    assert interfaces.length_um == pytest.approx(np.hypot(*(ends[1] - ends[0]).T), abs=1e-9)
    assert np.hypot(interfaces.normal_x, interfaces.normal_y) == pytest.approx(1.0)
    # Unsheared steel has every kind.
    assert set(interfaces.kind) == {
        "lamella",
        "cementite",
        "colony",
        "block",
        "prior_austenite_grain",
        "notch",
    }
    assert mesh.to_dict().keys() == elements.to_dict().keys()
    assert all("um" in name for name in ("x_um", "y_um", "area_um2") if name in elements.columns)


def test_nothing_of_a_mesh_can_be_written_to() -> None:
    mesh = pp.build_mesh(small_scene(), "undeformed")
    for array in (mesh.vertices_um, *mesh.elements.to_dict().values()):
        assert not array.flags.writeable


@pytest.mark.parametrize(
    ("state", "index", "message"),
    [
        ("severe_at", 0, "scene small: state severe_at is unknown, did you mean severe_AT?"),
        ("none", 0, "state none is unknown, known are undeformed, severe_AT"),
        ("severe_AT", -1, "index -1 is negative"),
        ("severe_AT", 0.5, "index = 0.5 is not a whole number"),
    ],
)
def test_a_state_or_a_number_that_is_not_there_is_refused(
    state: str, index: int, message: str
) -> None:
    with pytest.raises(pp.PearliteError) as refused:
        pp.build_mesh(small_scene(), state, index)
    assert message in str(refused.value)


def test_a_mesh_draws_itself_on_new_and_on_given_axes() -> None:
    mesh = pp.build_mesh(small_scene(), "severe_AT")
    axes = mesh.plot()
    assert axes.get_xlabel() == "x [µm]"
    assert (axes.get_xlim(), axes.get_ylim()) == ((0.0, 80.0), (0.0, 80.0))
    assert sum(len(lines.get_segments()) for lines in axes.collections) == len(mesh.interfaces)
    _, given = pyplot.subplots()
    assert mesh.plot(given) is given
    assert mesh.plot(ax=given) is given
    pyplot.close("all")


def test_the_text_tells_state_number_and_size() -> None:
    mesh = pp.build_mesh(small_scene(), "severe_AT", index=1)
    elements, interfaces = len(mesh.elements), len(mesh.interfaces)
    assert repr(mesh) == (
        f"<Mesh severe_AT 1: {elements:,} elements, {interfaces:,} interfaces, "
        "window 80 x 80 um, seed 1>"
    )
