"""A mesh on one rank: what is gathered, shared and rewound. ``tests/mpi`` has several ranks."""

import numpy as np
import pytest
from mpi4py import MPI

from pearlite_petsc.growth.case import CrackCase
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.growth.load import TipLoad
from pearlite_petsc.growth.prepared import prepare_growth
from pearlite_petsc.scene import Kind
from tests.scenes import STATES, default_scene

SCENE = default_scene(
    window={"width": 60.0, "height": 60.0, "notch": 25.0},
    elements={"width": 3.0, "length": 6.0},
    solver={"relative_tolerance": 1e-10},
)
CASE = CrackCase(SCENE, STATES["moderate_AT"], 18e3)
PREPARED = prepare_growth(SCENE, CASE.state, 0)
MESH = PREPARED.mesh


def domain_of(keep_first: bool = False) -> Domain:
    return Domain(MPI.COMM_SELF, SCENE, MESH, PREPARED.ratio, keep_first=keep_first)


def test_what_is_scattered_comes_back() -> None:
    with domain_of() as domain:
        values = np.random.default_rng(1).uniform(size=(MESH.interface_count, 3))
        assert np.array_equal(domain.gather(domain.scatter(values)), values)
        elements = np.random.default_rng(2).uniform(size=(MESH.element_count, 2))
        own = domain.scatter_elements(elements)
        assert np.array_equal(domain.gather_elements(own), elements)


def test_edges_have_the_elements_junctions_and_places_of_the_mesh() -> None:
    chosen = np.array([5, 17, 40])
    with domain_of() as domain:
        edges = domain.edges(chosen)
        assert edges.numbers.tolist() == chosen.tolist() == domain.local(edges).tolist()
    assert np.array_equal(edges.elements, MESH.interface_elements[chosen])
    assert np.array_equal(edges.junctions, MESH.junction[MESH.interface_vertices[chosen]])
    # A junction is one place where several vertices meet closely.
    assert np.abs(edges.ends - MESH.vertices[MESH.interface_vertices[chosen]]).max() < 0.1


def test_an_intact_mesh_starts_with_its_notch_alone_broken() -> None:
    with domain_of() as domain:
        broken = domain.equilibrium.system.damage >= 1.0
    assert np.array_equal(broken, MESH.kind == Kind.NOTCH)


def test_motions_are_scaled_to_angles_and_open_the_notch() -> None:
    with domain_of() as domain:
        unknowns = domain.equilibrium.solve(TipLoad(CASE, domain.subdomain).at(MESH.notch))
        motions = domain.motions()
        assert motions is not None
        assert motions[:, 2] * domain.subdomain.rotation_length == pytest.approx(unknowns[:, 2])
    left = MESH.centre[:, 0] < 12.0
    above = motions[left & (MESH.centre[:, 1] > 40.0), 1].mean()
    below = motions[left & (MESH.centre[:, 1] < 20.0), 1].mean()
    assert above - below > 0.0


def test_a_rewound_domain_solves_as_at_the_start_bit_for_bit() -> None:
    with domain_of(keep_first=True) as domain:
        load = TipLoad(CASE, domain.subdomain).at(MESH.notch)
        start = domain.equilibrium.system.damage.copy()
        first = domain.equilibrium.solve(load).copy()
        softened = np.where(start >= 1.0, 1.0, 0.4)
        domain.equilibrium.update(softened)
        other = domain.equilibrium.solve(load)
        assert np.abs(other - first).max() > 0.1 * np.abs(first).max()
        domain.rewind()
        assert np.array_equal(domain.equilibrium.solve(load), first)
