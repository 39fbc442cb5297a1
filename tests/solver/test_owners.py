"""Local and owned interfaces of a rank, and values from their owners."""

import numpy as np
from mpi4py import MPI

from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.solver.owners import from_owners, local_interfaces, owned_interfaces
from pearlite_petsc.solver.subdomain import element_ranges, subdomain_of
from tests.solver.bodies import NOTCHED, STEEL

COUNT = NOTCHED.interface_count


def test_each_rank_finds_what_it_has_and_one_of_them_owns_it() -> None:
    stiffness = spring_stiffness(NOTCHED, STEEL)
    asked = np.array([COUNT - 1, 0, COUNT // 2, COUNT // 3])
    owners = np.zeros(len(asked), dtype=int)
    for ends in element_ranges(NOTCHED.element_count, 3):
        subdomain = subdomain_of(NOTCHED, stiffness, *ends)
        row, place = local_interfaces(subdomain, asked)
        assert np.array_equal(subdomain.interfaces.numbers[place], asked[row])
        missing = np.setdiff1d(asked, asked[row])
        assert not np.isin(missing, subdomain.interfaces.numbers).any()
        mine, _ = owned_interfaces(subdomain, asked)
        assert set(mine) <= set(row)
        owners[mine] += 1
    assert np.array_equal(owners, np.ones(len(asked)))


def test_values_come_in_the_order_asked_for() -> None:
    whole = subdomain_of(NOTCHED, spring_stiffness(NOTCHED, STEEL), 0, NOTCHED.element_count)
    asked = np.array([7, 2, COUNT - 1])
    values = np.arange(2.0 * COUNT).reshape(COUNT, 2)
    assert np.array_equal(from_owners(MPI.COMM_SELF, whole, asked, values), values[asked])
