"""Rate constants of a mesh's interfaces, and laws that follow the crack."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from pearlite_petsc.fatigue.damage import crack_distance
from pearlite_petsc.growth.case import CrackCase
from pearlite_petsc.growth.damage_rates import DamageRates
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.growth.prepared import prepare_growth
from pearlite_petsc.laws import DamageInterfaces, DamageLaw, RateConstants
from pearlite_petsc.scene import Damage, Kind
from tests.scenes import STATES, default_scene

SCENE = default_scene(
    window={"width": 60.0, "height": 60.0, "notch": 25.0}, elements={"radius": 12.0}
)
CASE = CrackCase(SCENE, STATES["undeformed"], 18e3)
PREPARED = prepare_growth(SCENE, CASE.state, 0)
MESH = PREPARED.mesh
NOTCH = MESH.kind == Kind.NOTCH


def by_distance(interfaces: DamageInterfaces, damage: Damage) -> RateConstants:
    distance = interfaces.crack_distance
    return RateConstants(np.ones(len(distance)), distance, damage.beta)


FOLLOWING = DamageLaw(
    name="by_distance", help="for tests", function=by_distance, follows_crack=True
)


def domain_of() -> Domain:
    return Domain(MPI.COMM_SELF, SCENE, MESH, PREPARED.ratio)


def test_coarse_elements_take_no_damage_and_fine_ones_do() -> None:
    with domain_of() as domain:
        factor = DamageRates(domain, CASE, NOTCH).constants.factor
        fine = domain.subdomain.interfaces.fine
    assert 0 < fine.sum() < len(fine)
    assert (factor[fine] > 0.0).all() and not factor[~fine].any()


def test_a_law_that_follows_the_crack_sees_the_nearest_of_what_has_broken() -> None:
    scene = replace(SCENE, damage=replace(SCENE.damage, law=FOLLOWING))
    gap = np.where(NOTCH, np.inf, np.hypot(*(MESH.midpoint - MESH.notch).T))
    ahead = np.argsort(gap)[:6]
    with domain_of() as domain:
        rates = DamageRates(domain, replace(CASE, scene=scene), NOTCH)
        before = rates.constants.threshold.copy()
        ends = domain.subdomain.interfaces.ends
        assert before == pytest.approx(crack_distance(MESH.midpoint, ends[NOTCH]))
        rates.follow(domain.edges(np.empty(0, dtype=np.int64)))
        assert np.array_equal(rates.constants.threshold, before)
        rates.follow(domain.edges(np.sort(ahead)))
        broken = NOTCH.copy()
        broken[ahead] = True
        exact = crack_distance(MESH.midpoint, ends[broken])
        assert rates.constants.threshold == pytest.approx(exact)
        again = DamageRates(domain, replace(CASE, scene=scene), broken)
    assert again.constants.threshold == pytest.approx(exact)
    assert (exact < before).any()


def test_the_shipped_law_does_not_ask_where_the_crack_is() -> None:
    with domain_of() as domain:
        rates = DamageRates(domain, CASE, NOTCH)
        before = rates.constants
        rates.follow(domain.edges(np.flatnonzero(~NOTCH)[:4]))
    assert np.array_equal(rates.constants.threshold, before.threshold)
    assert np.isfinite(before.threshold).all()
