"""A domain on several ranks against the same on one; ``test_domain`` starts it."""

import sys

import mpi4py

mpi4py.rc.thread_level = "funneled"

import numpy as np  # noqa: E402
from mpi4py import MPI  # noqa: E402

from pearlite_petsc.growth.body import CrackedBody  # noqa: E402
from pearlite_petsc.growth.case import CrackCase  # noqa: E402
from pearlite_petsc.growth.domain import Domain  # noqa: E402
from pearlite_petsc.growth.prepared import prepare_growth  # noqa: E402
from tests.scenes import STATES, default_scene  # noqa: E402

SCENE = default_scene(
    window={"width": 60.0, "height": 60.0, "notch": 25.0},
    elements={"width": 3.0, "length": 6.0},
    solver={"relative_tolerance": 1e-10},
)


def main() -> None:
    world = MPI.COMM_WORLD
    # From protocol 5 on a read-only array arrives as one: here the domain itself must see to it.
    MPI.pickle.PROTOCOL = 4
    case = CrackCase(SCENE, STATES["moderate_TA"], 18e3)
    prepared = prepare_growth(SCENE, case.state, 0)
    mesh = prepared.mesh
    first = world.rank == 0
    domain = Domain(world, SCENE, mesh if first else None, prepared.ratio if first else None)

    interfaces, boundary = domain.subdomain.interfaces, domain.subdomain.boundary
    of_interfaces = interfaces.length, interfaces.ends, interfaces.stiffness.k_n
    arrays = domain.subdomain.centre, boundary.facet_start, *of_interfaces
    assert not any(array.flags.writeable for array in arrays)

    values = np.random.default_rng(1).uniform(size=(mesh.interface_count, 3))
    local = domain.scatter(values if first else None)
    assert np.array_equal(local, values[interfaces.numbers])
    back = domain.gather(local)
    assert (back is None) != first
    assert back is None or np.array_equal(back, values)

    elements = np.random.default_rng(2).uniform(size=(mesh.element_count, 2))
    own = domain.scatter_elements(elements if first else None)
    assert len(own) == domain.subdomain.owned_count < mesh.element_count
    whole = domain.gather_elements(own)
    assert whole is None or np.array_equal(whole, elements)

    # Every rank names what it has of some interfaces; all see each of them once.
    wanted = np.arange(3, mesh.interface_count, 7)
    edges = domain.edges(np.flatnonzero(np.isin(interfaces.numbers, wanted)))
    assert np.array_equal(edges.numbers, wanted)
    assert np.array_equal(np.sort(edges.elements), np.sort(mesh.interface_elements[wanted]))
    here = interfaces.numbers[domain.local(edges)]
    assert np.array_equal(here, np.intersect1d(interfaces.numbers, wanted))

    damage = domain.scatter(values[:, 0] if first else None).copy()
    damage[interfaces.numbers == wanted[0]] = 1.0
    body = CrackedBody(domain, case, np.where(damage == 1.0, 1.0, 0.0))
    jump = domain.gather(body.solve(0.3 * damage))
    motions = domain.motions()
    if first:
        alone = Domain(MPI.COMM_SELF, SCENE, mesh, prepared.ratio)
        one = CrackedBody(alone, case, np.where(np.arange(len(values)) == wanted[0], 1.0, 0.0))
        single = 0.3 * values[:, 0]
        single[wanted[0]] = 0.3
        exact = one.solve(single)
        assert np.abs(jump - exact).max() < 1e-6 * np.abs(exact).max()
        moved = alone.motions()
        assert np.abs(motions - moved).max() < 1e-6 * np.abs(moved).max()
        assert one.tracker.tip == body.tracker.tip
        alone.close()
    domain.close()
    if first:
        sys.stdout.write(f"{world.size} ranks are one\n")


if __name__ == "__main__":
    main()
