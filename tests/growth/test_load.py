"""The load range on the window: balanced, as large as asked for, and following the tip."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from pearlite_petsc.fatigue.release import released
from pearlite_petsc.growth.body import CrackedBody
from pearlite_petsc.growth.case import CrackCase
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.growth.load import TipLoad, softening_tip
from pearlite_petsc.growth.prepared import prepare_growth
from pearlite_petsc.mechanics.lefm import remote_stress
from pearlite_petsc.scene import Kind, Scene
from tests.scenes import STATES, default_scene

SCENE = default_scene(
    window={"width": 60.0, "height": 60.0, "notch": 25.0}, elements={"width": 3.0, "length": 6.0}
)
PREPARED = prepare_growth(SCENE, STATES["moderate_AT"], 0)
MESH = PREPARED.mesh


def domain_of() -> Domain:
    return Domain(MPI.COMM_SELF, SCENE, MESH, PREPARED.ratio)


def case_of(scene: Scene, delta_k: float = 18e3) -> CrackCase:
    return CrackCase(scene, STATES["moderate_AT"], delta_k)


def with_loading(kind: str, control: str) -> Scene:
    return replace(SCENE, loading=replace(SCENE.loading, kind=kind, control=control))


@pytest.mark.parametrize("kind", ["k_field", "edge_crack"])
def test_load_is_in_balance_and_grows_with_delta_k(kind: str) -> None:
    scene = with_loading(kind, "K")
    with domain_of() as domain:
        once = TipLoad(case_of(scene), domain.subdomain).at((30.0, 31.0))
        twice = TipLoad(case_of(scene, 36e3), domain.subdomain).at((30.0, 31.0))
    assert twice == pytest.approx(2.0 * once, rel=1e-12)
    size = np.abs(once[:, :2]).sum()
    x, y = MESH.centre.T
    moment = once[:, 2] + x * once[:, 1] - y * once[:, 0]
    assert np.abs(once[:, :2].sum(axis=0)).max() < 1e-6 * size
    assert abs(moment.sum()) < 1e-6 * size * SCENE.window.width


@pytest.mark.parametrize(("control", "follows"), [("K", True), ("stress", False)])
def test_an_edge_crack_is_pulled_by_the_remote_stress_of_its_length(
    control: str, follows: bool
) -> None:
    with domain_of() as domain:
        load = TipLoad(case_of(with_loading("edge_crack", control)), domain.subdomain)
        near, far = load.at((25.0, 30.0)), load.at((35.0, 30.0))
    upper = MESH.centre[:, 1] > 30.0
    for value, length in ((near, 25.0), (far, 35.0 if follows else 25.0)):
        stress = remote_stress(18e3, length, SCENE.window.width)
        assert value[upper, 1].sum() == pytest.approx(stress * SCENE.window.width, rel=1e-9)


def test_the_load_moves_with_the_force_that_a_lengthening_interface_lets_go() -> None:
    with domain_of() as domain:
        notch = (MESH.kind == Kind.NOTCH).astype(float)
        body = CrackedBody(domain, case_of(SCENE), notch)
        tip = body.tracker.tip
        own, intact = domain.subdomain.interfaces, notch < 1.0

        def tip_after(number: int) -> tuple[float, float]:
            interface = own.elements[number], own.junctions[number], own.ends[number]
            return body.tracker.tip_after(tuple(each.tolist() for each in interface))

        ahead = max(np.flatnonzero(intact), key=lambda number: tip_after(number)[0])
        end = tip_after(ahead)
        assert end[0] > tip[0]
        gone = np.where(intact, 0.0, 1.0)
        assert softening_tip(domain, body.tracker, gone, intact) == tip
        gone[ahead] = released(0.5, 0.3)
        x, y = softening_tip(domain, body.tracker, gone, intact)
        assert x - tip[0] == pytest.approx(gone[ahead] * (end[0] - tip[0]))
        assert y - tip[1] == pytest.approx(gone[ahead] * (end[1] - tip[1]))
        gone[ahead] = 1.0
        assert softening_tip(domain, body.tracker, gone, intact) == pytest.approx(end)
