"""What can be left anywhere is left when a stop is wanted, and the timer is off after it."""

import signal
import threading

import pytest

from pearlite_petsc.ensemble.stop import StoppedError, left_when


def endless() -> None:
    while True:
        sum(range(100))


def assert_the_timer_is_off() -> None:
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
    assert signal.getsignal(signal.SIGALRM) == signal.SIG_DFL


def test_an_endless_loop_is_left_at_the_first_wish() -> None:
    asked: list[int] = []

    def stopping() -> bool:
        asked.append(len(asked))
        return len(asked) == 3

    with pytest.raises(StoppedError), left_when(stopping):
        endless()
    assert len(asked) == 3
    assert_the_timer_is_off()


def test_without_a_wish_everything_is_as_before() -> None:
    with left_when(lambda: False):
        result = sum(range(10))
    assert result == 45
    assert_the_timer_is_off()


def test_an_error_inside_comes_out_and_the_timer_is_off() -> None:
    with pytest.raises(ValueError, match="mesh"), left_when(lambda: False):
        raise ValueError("mesh")
    assert_the_timer_is_off()


def test_an_error_of_the_question_comes_out_too() -> None:
    def broken() -> bool:
        raise OSError("disk")

    with pytest.raises(OSError, match="disk"), left_when(broken):
        endless()
    assert_the_timer_is_off()


def test_other_threads_have_no_signals_and_are_not_left() -> None:
    seen: list[str] = []

    def work() -> None:
        with left_when(lambda: True):
            seen.append("done")

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert seen == ["done"]
