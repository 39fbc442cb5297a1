"""What a user is told of a growing ensemble: a line a task, where it stands, ``progress.json``."""

import json
import logging
from collections.abc import Callable, Sequence
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.ensemble.expected import Forecast
from pearlite_petsc.ensemble.status import REASONS, Status
from pearlite_petsc.ensemble.tasks import Task
from pearlite_petsc.launch.display import Screen, Standing, clock
from pearlite_petsc.output.tables import UM_PER_M
from pearlite_petsc.output.whole_file import whole_file

_log = logging.getLogger(__name__)

LOOK_SECONDS = 0.25
FILE_SECONDS = 1.0


class Progress:
    """Shows the board's news. World's first rank only.

    Args:
        path: ``progress.json``.
        tasks: All tasks.
        forecast: Expected wall times.
        groups: Groups at work.
        screen: Where to show it.
    """

    def __init__(
        self,
        path: Path,
        tasks: Sequence[Task],
        forecast: Forecast,
        groups: int,
        screen: Screen,
    ) -> None:
        self._path, self._tasks, self._forecast, self._groups = path, tasks, forecast, groups
        self._screen = screen
        self._started = monotonic()
        self._looked = self._filed = -np.inf
        self._since = np.full(len(tasks), np.nan)
        self._seen: IntArray | None = None

    def is_due(self) -> bool:
        """Return whether it is time to look at the board again."""
        return monotonic() - self._looked >= LOOK_SECONDS

    def show(
        self,
        status: IntArray,
        values: FloatArray,
        last: bool = False,
        remark: Callable[[int], str] = lambda number: "",
    ) -> None:
        """Show what is new.

        Args:
            status: ``Board.status``; (n,).
            values: ``Board.values``; (n, columns).
            last: Whether the run ends here.
            remark: Returns what is to be said of a finished task beside its line, "" for nothing.
        """
        self._looked = now = monotonic()
        running = status == Status.RUNNING
        self._since[running & np.isnan(self._since)] = now
        finished = np.isin(status, (Status.DONE, Status.FAILED))
        before = (
            finished if self._seen is None else np.isin(self._seen, (Status.DONE, Status.FAILED))
        )
        self._seen = status
        fresh = np.flatnonzero(finished & ~before)
        left = 0.0 if last else self._seconds_left(status, values, now)
        count = int(finished.sum())
        failed, active = int((status == Status.FAILED).sum()), int(running.sum())
        for place, number in enumerate(fresh):
            line = self._line(int(number), values[number], count - len(fresh) + 1 + place)
            tail = f"running {active}  failed {failed}  {clock(left)} left"
            self._screen.line(f"{line}  {tail}")
            _log.info("%s", line)
            text = remark(int(number))
            if text:
                self._screen.trouble(f"{self._tasks[number].name}: {text}")
        if not last:
            total = len(self._tasks)
            self._screen.stand(Standing("growing", count, active, failed, total, left))
        if last or now - self._filed >= FILE_SECONDS:
            self._filed = now
            self._write(status, left, now, last)

    def _line(self, number: int, values: FloatArray, place: int) -> str:
        wall, rate, reason = values.tolist()
        width = len(str(len(self._tasks)))
        name = REASONS[int(reason)].value
        rate_text = f"{rate / UM_PER_M:.3e} m/cycle" if np.isfinite(rate) else "no growth rate"
        head = f"[{place:{width}}/{len(self._tasks)}] {self._tasks[number].name}"
        return f"{head}: {name}, {rate_text}, {wall:.2f} s"

    def _seconds_left(self, status: IntArray, values: FloatArray, now: float) -> float:
        expected = self._forecast.seconds(status, values)
        running = status == Status.RUNNING
        rest = np.maximum(expected[running] - (now - self._since[running]), 0.0)
        waiting = expected[status == Status.OPEN].sum()
        return max(float(waiting + rest.sum()) / self._groups, float(rest.max(initial=0.0)))

    def _write(self, status: IntArray, left: float, now: float, last: bool) -> None:
        content: dict[str, Any] = {
            "total": len(status),
            "done": int((status == Status.DONE).sum()),
            "failed": int((status == Status.FAILED).sum()),
            "running": [self._tasks[i].name for i in np.flatnonzero(status == Status.RUNNING)],
            "elapsed_s": round(now - self._started, 1),
            "left_s": round(left, 1),
            "ended": last,
        }
        try:
            with whole_file(self._path) as partial:
                partial.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
        except OSError as error:
            _log.warning("progress.json cannot be written: %s", error)
