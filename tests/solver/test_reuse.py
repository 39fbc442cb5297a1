"""When a preconditioner is renewed: a matter of counts alone, without a solver."""

from dataclasses import astuple, replace

import pytest

from pearlite_petsc.solver.reuse import (
    HALF_CYCLE_WORTH,
    MOST_HALF_CYCLES,
    SETUP_COST,
    ReusePolicy,
    many_iterations,
    setup_cost,
)

NEW = ReusePolicy(setup_cost=20.0)
MEASURED = NEW.after_whole_cycle(10)


def test_the_first_solve_measures_a_preconditioner_and_costs_nothing() -> None:
    assert (MEASURED.first_iterations, MEASURED.excess, MEASURED.is_fresh) == (10, 0.0, False)


def test_it_is_worn_once_the_iterations_beyond_the_first_solve_pay_for_a_new_one() -> None:
    policy, solves = MEASURED, 0
    while not policy.is_worn:
        policy = policy.after_whole_cycle(15)
        solves += 1
    # 4 x 5 iterations are not yet more than 20.
    assert solves == 5


def test_whoever_renews_so_spends_at_most_twice_the_best_possible() -> None:
    """Against the best fixed interval, for solves that take three iterations more each time."""
    growth, solves = 3, 60

    def cost_of(interval: int) -> int:
        return sum(
            20 + growth * (interval * (interval - 1) // 2) for _ in range(solves // interval)
        )

    best = min(cost_of(interval) for interval in range(1, solves + 1) if solves % interval == 0)
    policy, age, spent = NEW, 0, 20
    for _ in range(solves):
        if policy.is_worn:
            policy, age, spent = policy.worn_out().renewed(), 0, spent + 20
        spent += growth * age
        policy = policy.after_whole_cycle(10 + growth * age)
        age += 1
    assert spent <= 2 * best


def test_a_solve_faster_than_the_first_gives_nothing_back() -> None:
    assert MEASURED.after_whole_cycle(14).after_whole_cycle(2).excess == 4.0


def test_factors_just_made_are_not_measured_by_the_matrix_that_they_solve_exactly() -> None:
    policy = NEW.after_whole_cycle(1, measures=False)
    assert policy.is_fresh and policy.excess == 0.0
    assert policy.after_whole_cycle(6).first_iterations == 6


def test_half_the_cycle_waits_for_a_measure_and_for_hierarchies_that_do_well() -> None:
    likely = HALF_CYCLE_WORTH * MOST_HALF_CYCLES
    assert not NEW.takes_half_cycle
    assert MEASURED.takes_half_cycle
    assert NEW.after_whole_cycle(int(likely)).takes_half_cycle
    assert not NEW.after_whole_cycle(int(likely) + 1).takes_half_cycle


def test_half_a_cycle_in_vain_is_not_tried_again_and_its_iterations_count() -> None:
    failed = MEASURED.after_half_cycle(12, converged=False)
    assert failed.excess == 0.0 and not failed.takes_half_cycle
    assert failed.after_whole_cycle(9, in_vain=12).excess == 11.0
    assert failed.renewed().after_whole_cycle(10).takes_half_cycle


def test_iterations_of_half_the_cycle_count_for_what_they_reduce() -> None:
    assert MEASURED.after_half_cycle(20, converged=True).excess == HALF_CYCLE_WORTH * 20 - 10
    assert MEASURED.after_half_cycle(4, converged=True).excess == 0.0


def test_many_iterations_ask_once_for_hierarchies_that_coarsen_less_from_the_next_on() -> None:
    many = int(many_iterations(1e-9))
    assert not MEASURED.coarsens_too_much(many, 1e-9)
    assert MEASURED.coarsens_too_much(many + 1, 1e-9)
    policy = MEASURED.to_coarsen_less()
    assert policy.is_worn and not policy.is_finer
    assert not policy.coarsens_too_much(10 * many, 1e-9)
    # New factors or a refreshed hierarchy of the same damage is no step to the next.
    assert not policy.renewed().is_finer
    assert policy.worn_out().renewed().is_finer
    assert policy.worn_out().renewed().worn_out().renewed().is_finer


def test_what_only_a_direct_solver_could_do_ends_the_preconditioner() -> None:
    assert MEASURED.after_direct_solve().is_worn
    assert not MEASURED.after_direct_solve().renewed().is_worn


def test_a_policy_goes_on_from_its_numbers_alone() -> None:
    policy = MEASURED.to_coarsen_less().worn_out().renewed().after_whole_cycle(7)
    assert ReusePolicy(*astuple(policy)) == policy
    assert replace(policy, excess=1.0) != policy


@pytest.mark.parametrize(("size", "cost"), [*SETUP_COST, (1.0, 25.0), (1e9, 12.0)])
def test_set_ups_of_larger_matrices_cost_fewer_iterations(size: float, cost: float) -> None:
    assert setup_cost(int(size)) == cost


@pytest.mark.parametrize(("tolerance", "many"), [(1e-6, 19.0), (1e-9, 26.5), (0.0, 43.1)])
def test_good_hierarchies_take_two_and_a_half_iterations_a_digit(
    tolerance: float, many: float
) -> None:
    assert many_iterations(tolerance) == pytest.approx(many, abs=0.05)
