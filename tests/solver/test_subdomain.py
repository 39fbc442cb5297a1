"""Subdomains of several ranks: together the mesh, each interface owned once, read-only."""

import numpy as np
import pytest

from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.solver.subdomain import Subdomain, element_ranges, subdomain_of
from tests.solver.bodies import NOTCHED, STEEL


def subdomains(ranks: int) -> list[Subdomain]:
    stiffness = spring_stiffness(NOTCHED, STEEL)
    ranges = element_ranges(NOTCHED.element_count, ranks)
    return [subdomain_of(NOTCHED, stiffness, *ends) for ends in ranges]


@pytest.mark.parametrize("ranks", [1, 2, 5])
def test_every_element_and_interface_has_one_owner(ranks: int) -> None:
    found = subdomains(ranks)
    elements = [each.element_numbers[: each.owned_count] for each in found]
    assert np.array_equal(np.concatenate(elements), np.arange(NOTCHED.element_count))
    owned = [each.interfaces.numbers[each.owns_interface] for each in found]
    assert np.array_equal(np.sort(np.concatenate(owned)), np.arange(NOTCHED.interface_count))
    facets = sum(len(each.boundary.elements) for each in found)
    assert facets == len(NOTCHED.boundary_elements)


def test_a_rank_has_all_interfaces_of_its_elements_and_the_elements_behind_them() -> None:
    for each in subdomains(3):
        numbers = np.arange(NOTCHED.element_count)[each.owned_elements]
        touched = np.isin(NOTCHED.interface_elements, numbers).any(axis=1)
        assert np.array_equal(each.interfaces.numbers, np.flatnonzero(touched))
        elements = each.element_numbers[each.interfaces.elements]
        assert np.array_equal(elements, NOTCHED.interface_elements[touched])
        assert np.array_equal(each.centre, NOTCHED.centre[each.element_numbers])
        assert not np.isin(each.ghosts, numbers).any()
        assert np.array_equal(each.ghosts, np.unique(each.ghosts))


def test_what_ranks_share_has_the_same_bits_on_both() -> None:
    one, other = subdomains(2)
    both, here, there = np.intersect1d(
        one.interfaces.numbers, other.interfaces.numbers, return_indices=True
    )
    assert len(both) > 10
    assert np.array_equal(one.jump_operator()[here], other.jump_operator()[there])
    springs = [each.interfaces.spring_constants() for each in (one, other)]
    assert np.array_equal(springs[0][here], springs[1][there])


def test_its_arrays_are_read_only() -> None:
    (whole,) = subdomains(1)
    stiffness = whole.interfaces.stiffness
    for array in (whole.centre, whole.interfaces.length, stiffness.k_n, whole.boundary.facet_end):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
