"""The solver against others: iterations, set-up, solves and memory, over size, crack and ranks."""

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

from pearlite_petsc.errors import PearliteError
from pearlite_petsc.studies.table import say, write_rows

SOLVER_CASE = "solver_case"
"""Name by which the command measures one method on the ranks it is started with."""

OWN = "default"
METHODS = (OWN, "factors", "GAMG", "hypre", "MUMPS", "PyAMG")
OTHERS = METHODS[2:]
SIZES = (1e4, 1e5, 1e6)
QUICK_SIZES = (3e3,)
RANKS = (1, 2)
MOST_ITERATIONS = {"none": 20.0, "half": 40.0}
MOST_GROWTH = 1.3
MOST_WARM = 2.0
"""Processor time of a warm solve [ms per 1,000 unknowns]."""

LEAST_SPEED_UP = 1.6
MOST_ROUNDS, ENOUGH_SECONDS = 5, 150.0
"""Rounds of a method, of which the shortest times count: others on the machine only lengthen them.
None begins after so long for each number of ranks.
"""

LARGE, LARGEST = 5e4, 5e5
"""Unknowns from which the bars on time and on two ranks hold."""

Row = dict[str, Any]
Bar = tuple[str, float, float]
"""What, its value, the most that it may be."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``bench solver``."""
    parser.add_argument("--quick", action="store_true", help="one small body")
    parser.add_argument(
        "--unknowns", type=float, action="append", metavar="N", help="a size; may be given again"
    )
    parser.add_argument("--method", action="append", choices=METHODS, help="likewise")


def main(args: argparse.Namespace) -> int:
    """Measure, write ``solver.csv`` and the figure; 1 if a bar is missed."""
    sizes = args.unknowns or (QUICK_SIZES if args.quick else SIZES)
    rows: list[Row] = []
    for row in measure(sizes, args.method or METHODS, 1 if args.quick else MOST_ROUNDS):
        rows.append(row)
        say(
            f"{row['method']:8} {row['unknowns']:8d} crack {row['crack']:4}  {row['ranks']} rank(s)  "
            f"{row['iterations']:4d} iterations  set-up {row['setup_s']:8.3f} s  solve "
            f"{row['first_solve_s']:8.3f} s  warm {row['warm_solve_s']:8.4f} s  "
            f"{row['memory_mib_per_rank']:6.0f} MiB"
        )
        # After each, so that an interrupted run leaves what it has.
        write_rows(args.output / "solver.csv", rows)
    draw(args.output / "solver", rows)
    missed = [bar for bar in bars(rows) if not bar[1] <= bar[2]]
    for text, value, most in bars(rows):
        say(f"{'ok    ' if value <= most else 'MISSED'} {text}: {value:.3g} (at most {most:.3g})")
    return 1 if missed else 0


def measure(sizes: Sequence[float], methods: Sequence[str], most_rounds: int) -> Iterator[Row]:
    """Yield a row for every method, size and crack; the default on two ranks too.

    The rounds of one and of two ranks take turns, so that both meet the machine alike.
    """
    for size in sizes:
        with TemporaryDirectory() as folder:
            make = (
                "import sys; from pathlib import Path; "
                "from pearlite_petsc.studies.benchmarks.solver_bodies import write_bodies; "
                "write_bodies(Path(sys.argv[1]), float(sys.argv[2]), "
                "tuple(map(int, sys.argv[3:])))"
            )
            # In a process of its own: the mesh must not count as memory of what follows.
            _run([sys.executable, "-c", make, folder, str(size), *map(str, RANKS)])
            for method in methods:
                counts = RANKS if method == OWN else RANKS[:1]
                rounds: list[list[Row]] = []
                started = perf_counter()
                enough = ENOUGH_SECONDS * len(counts)
                while len(rounds) < most_rounds and perf_counter() - started < enough:
                    cases = (_case(Path(folder), method, ranks) for ranks in counts)
                    rounds.append([row for case in cases for row in case])
                    if not rounds[-1]:
                        # Not there, and said once.
                        break
                yield from map(shortest, zip(*rounds, strict=True))


def shortest(rows: Sequence[Row]) -> Row:
    """Return the shortest set-up, first and warm solve of all rounds, the rest as in the first."""
    timed = ("setup_s", "first_solve_s", "warm_solve_s")
    best = {name: min(row[name] for row in rows) for name in timed}
    return {**rows[0], **best, "solution_s": best["setup_s"] + best["first_solve_s"]}


def _case(folder: Path, method: str, ranks: int) -> Iterator[Row]:
    result = folder / "result.json"
    program = [sys.executable, "-m", "pearlite_petsc.bench", SOLVER_CASE]
    _run(["mpirun", "-n", str(ranks), *program, str(folder), method, str(result)])
    found = json.loads(result.read_text(encoding="utf-8"))
    if found["missing"]:
        say(f"{method}: left out, {found['missing']}")
    for row in found["rows"]:
        yield {"method": method, "ranks": ranks, **row}


def _run(command: Sequence[str]) -> None:
    # One thread a rank; more would be counted as one.
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise PearliteError(f"{' '.join(command[-3:])}: exit status {done.returncode}: {last}")


def bars(rows: Sequence[Row]) -> Iterator[Bar]:
    """Yield what the solver is held to, each with its value and the most it may be."""
    alone = {
        (row["method"], row["unknowns"], row["crack"]): row for row in rows if row["ranks"] == 1
    }
    for (method, unknowns, crack), row in alone.items():
        where = f"{unknowns} unknowns, crack {crack}"
        if method != OWN:
            continue
        count = row["iterations"] if row["iterations"] >= 0 else float("inf")
        yield f"iterations, {where}", count, MOST_ITERATIONS[crack]
        if unknowns < LARGE:
            continue
        yield (
            f"warm solve [ms per 1,000 unknowns], {where}",
            1e6 * row["warm_solve_s"] / unknowns,
            MOST_WARM,
        )
        for other in OTHERS:
            slower = alone.get((other, unknowns, crack), {"iterations": -1})
            if slower["iterations"] >= 0:
                share = row["solution_s"] / slower["solution_s"]
                yield f"time to solution over that of {other}, {where}", share, 1.0
    counts = [
        row["iterations"]
        for (method, _, crack), row in alone.items()
        if method == OWN and crack == "none"
    ]
    if len(counts) > 1:
        yield "growth of iterations with size", counts[-1] / counts[0], MOST_GROWTH
    for row in rows:
        one = alone.get((row["method"], row["unknowns"], row["crack"]))
        if row["ranks"] > 1 and one is not None:
            yield from _scaling(row, one)


def _scaling(row: Row, one: Row) -> Iterator[Bar]:
    """Yield the bars on several ranks against one."""
    where = f"{row['ranks']} ranks, {row['unknowns']} unknowns, crack {row['crack']}"
    if row["unknowns"] >= LARGEST:
        share = row["solution_s"] / one["solution_s"]
        yield f"time over that of one rank, {where}", share, 1.0 / LEAST_SPEED_UP
    if row["unknowns"] >= LARGE:
        share = row["memory_mib_per_rank"] / one["memory_mib_per_rank"]
        yield f"memory of a rank over that of one alone, {where}", share, 1.0


def draw(path: Path, rows: Sequence[Row]) -> None:
    """Draw the time to solution over the unknowns, intact and cracked."""
    from pearlite_petsc.output.figures.scaling import draw_times

    panels: dict[str, dict[str, list[tuple[float, float]]]] = {}
    for row in rows:
        if row["iterations"] < 0:
            continue
        name = row["method"] if row["ranks"] == 1 else f"{row['method']}, {row['ranks']} ranks"
        title = "intact" if row["crack"] == "none" else "crack half through"
        points = panels.setdefault(title, {}).setdefault(name, [])
        points.append((row["unknowns"], row["solution_s"]))
    dashed = {f"{OWN}, {ranks} ranks" for ranks in RANKS[1:]}
    draw_times(path, panels, "unknowns", "set-up and solve to 1e-8 [s]", dashed)
