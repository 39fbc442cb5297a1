"""Command: growth rates of a measured or computed crack from its length over cycles.

``pearlite evaluate a_N.csv``
"""

import csv
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from pearlite_petsc.command_line import CommandParser, add_output_option, complain
from pearlite_petsc.errors import PearliteError, SceneError
from pearlite_petsc.exit_status import ExitStatus
from pearlite_petsc.fatigue.growth_curve import THRESHOLD_RATE, power_law, threshold
from pearlite_petsc.fatigue.growth_rate import incremental_polynomial, secant, slope
from pearlite_petsc.output.length_file import LengthHistory, read_lengths
from pearlite_petsc.output.tables import UM_PER_M
from pearlite_petsc.output.whole_file import whole_file

_EXAMPLES = """examples:
  pearlite evaluate a_N.csv
  pearlite evaluate runs/quickstart/growth/severe_AT_m0_dk18.csv --output rates.csv

The file has the columns cycles and crack_length_um (or crack_length_mm), and delta_k_mpa_sqrt_m
if Delta-K is known. As in the program's own rates, only rows at which the crack is longer than in
all rows before count.
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return 0, or 2 for input that cannot be used."""
    parser = CommandParser(
        "evaluate",
        "Compute growth rates da/dN of one crack from its length over cycles, after ASTM E647.",
        _EXAMPLES,
    )
    parser.add_argument("file", type=Path, metavar="FILE.csv", help="crack length over cycles")
    add_output_option(
        parser,
        "table of the rates point by point; default <FILE>_da_dn.csv beside the file",
        metavar="FILE.csv",
    )
    parser.add_argument("--overwrite", action="store_true", help="replace an existing file")
    chosen = parser.parse_args(arguments)
    output = chosen.output or chosen.file.with_name(f"{chosen.file.stem}_da_dn.csv")
    try:
        history = read_lengths(chosen.file)
        if output.exists() and not chosen.overwrite:
            raise SceneError(f"{output} exists; --overwrite replaces it, --output names another")
        _write(output, history)
    except (PearliteError, OSError) as error:
        complain(str(error))
        return ExitStatus.BAD_INPUT
    sys.stdout.write(report(history) + f"wrote {output}\n")
    return ExitStatus.DONE


def report(history: LengthHistory) -> str:
    """Return what the command prints: points, rates of the whole crack, slope and threshold."""
    n, a = history.cycles, history.crack_length
    whole = (a[-1] - a[0]) / (n[-1] - n[0]) if n[-1] > n[0] else np.nan
    lines = [*history.notes]
    lines += [
        f"points: {len(n)}; rows without growth passed over: {history.passed_over}",
        f"growth: {a[-1] - a[0]:.6g} um in {n[-1] - n[0]:.6g} cycles",
        f"da/dN of all of it, least squares: {slope(n, a) / UM_PER_M:.6g} m/cycle",
        f"da/dN of all of it, growth over cycles: {whole / UM_PER_M:.6g} m/cycle",
    ]
    if history.delta_k is not None:
        rate = incremental_polynomial(n, a) / UM_PER_M
        law = power_law(history.delta_k, rate)
        if law is None:
            lines.append("slope of log da/dN over log Delta-K: needs two Delta-K and nine points")
        else:
            lines.append(
                f"slope of log da/dN over log Delta-K: {law.slope:.4g} "
                f"+- {law.slope_error:.2g} (95 %, {law.points} points)"
            )
        found = threshold(history.delta_k, rate)
        known = f"{found:.4g} MPa sqrt(m)" if np.isfinite(found) else "the rates do not reach it"
        lines.append(f"threshold at {THRESHOLD_RATE:g} m/cycle (ASTM E647): {known}")
    return "\n".join(lines) + "\n"


def _write(path: Path, history: LengthHistory) -> None:
    n, a = history.cycles, history.crack_length
    columns = {"cycles": n, "crack_length_um": a}
    if history.delta_k is not None:
        columns["delta_k_mpa_sqrt_m"] = history.delta_k
    columns["secant_m_per_cycle"] = secant(n, a) / UM_PER_M
    columns["polynomial_m_per_cycle"] = incremental_polynomial(n, a) / UM_PER_M
    with whole_file(path) as partial, partial.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(columns)
        table = zip(*(values.tolist() for values in columns.values()), strict=True)
        writer.writerows([repr(value) for value in row] for row in table)


if __name__ == "__main__":
    sys.exit(main())
