"""Lines and bar: what stays, what is redrawn, and a reader who has gone."""

import io
import os
from time import sleep

import pytest

from pearlite_petsc.launch import display as module
from pearlite_petsc.launch.display import Display, Standing, clock
from tests.terminal import CLEAR

STANDING = Standing("growing", 18, 2, 1, 80, 75.0)


def test_a_bar_counts_the_time_down_between_two_reports() -> None:
    assert STANDING.text(5.0, 60.0) == (
        "[####----------------] 18/80 done, 2 running, 1 failed, 1:10 left, 1:00 so far"
    )
    assert STANDING.text(500.0, 600.0).endswith("0:00 left, 10:00 so far")
    assert (
        Standing("drawing figure 3 of 10").text(0.0, 4.0) == "drawing figure 3 of 10, 0:04 so far"
    )


def test_lines_scroll_above_the_bar_and_the_prompt_is_clean() -> None:
    stream = io.StringIO()
    with Display(stream, terminal=True) as display:
        display.stand(STANDING)
        display.line("[18/80] a crack")
        display.stand(Standing("writing the results"))
    first, second = stream.getvalue().split("\n")
    assert first.endswith(f"so far{CLEAR}[18/80] a crack")
    assert second.startswith(f"{CLEAR}[###")
    assert f"so far{CLEAR}writing the results" in second
    assert second.endswith(CLEAR)


def test_a_narrow_terminal_shows_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "30")
    stream = io.StringIO()
    with Display(stream, terminal=True) as display:
        display.stand(STANDING)
    assert max(map(len, stream.getvalue().split(CLEAR))) == 29


def test_the_bar_moves_although_nobody_reports(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "REDRAW_SECONDS", 0.01)
    stream = io.StringIO()
    with Display(stream, terminal=True) as display:
        display.stand(STANDING)
        sleep(0.2)
    assert stream.getvalue().count("18/80 done") > 3


def test_without_a_terminal_the_bar_is_a_line_after_a_long_silence(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "REDRAW_SECONDS", 0.01)
    stream = io.StringIO()
    with Display(stream, quiet=0.15) as display:
        display.stand(STANDING)
        display.line("a crack")
        sleep(0.35)
    first, *more = stream.getvalue().splitlines()
    assert first == "a crack"
    assert 1 <= len(more) <= 3
    assert "18/80 done, 2 running" in more[0]
    with Display(quiet_stream := io.StringIO()) as display:
        display.stand(STANDING)
    assert quiet_stream.getvalue() == ""


def test_a_user_who_has_gone_stops_nothing() -> None:
    read, write = os.pipe()
    os.close(read)
    with os.fdopen(write, "w") as stream:
        with Display(stream, terminal=True) as display:
            display.stand(STANDING)
            display.line("a crack")
        # Else closing the stream would report what it could not send off.
        os.dup2(os.open(os.devnull, os.O_WRONLY), write)


@pytest.mark.parametrize("seconds, text", [(0.4, "0:00"), (59.6, "1:00"), (3725.0, "1:02:05")])
def test_times_are_read_as_clocks(seconds: float, text: str) -> None:
    assert clock(seconds) == text
