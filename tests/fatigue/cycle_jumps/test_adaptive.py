import numpy as np

from pearlite_petsc.fatigue.cycle_jumps.adaptive import Adaptive
from pearlite_petsc.fatigue.cycle_jumps.situation import Memory
from tests.fatigue.cycle_jumps.body import COUNT, Body


def test_a_smaller_tolerance_takes_more_blocks() -> None:
    loose, tight = Body(most_coupled=2), Body(most_coupled=2)
    many = [
        body.until_first_break(Adaptive(1.0, tolerance))[2]
        for body, tolerance in ((loose, 0.1), (tight, 1e-3))
    ]
    assert many[1] > 2 * many[0]
    # A rejected block costs its solve.
    assert len(tight.trials) > many[1]


def test_a_rejected_block_is_tried_again_shorter() -> None:
    body = Body(most_coupled=1)
    block = body.block(Adaptive(1.0, 1e-3), body.situation(np.zeros(COUNT)))
    assert block is not None and block.counts["rejected"] >= 1
    cycles = [trial.cycles for trial in body.trials]
    assert block.cycles <= cycles[-1] * 1.01 < cycles[0]


def test_the_next_block_starts_with_the_length_that_was_learned() -> None:
    body = Body()
    start = body.situation(np.zeros(COUNT))
    first = body.block(Adaptive(0.3, 0.05), start)
    assert first is not None
    learned = first.memory.numbers["delta_d"]
    assert 0.3 < learned <= 0.6
    short, long = (
        body.block(Adaptive(0.3, 0.05), body.situation(start.damage, memory=memory))
        for memory in (Memory(), Memory(numbers={"delta_d": learned}))
    )
    assert short is not None and long is not None and long.cycles > short.cycles
