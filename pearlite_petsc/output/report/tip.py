"""K at the tip in the report: asked for against measured."""

from pearlite_petsc.output.figures.style import state_label
from pearlite_petsc.output.report.elements import paragraph, table
from pearlite_petsc.output.result_folder import Result
from pearlite_petsc.output.statistics import Estimate
from pearlite_petsc.output.tables import delta_k_in_mpa_sqrt_m
from pearlite_petsc.output.tip_statistics import MOST_MISFIT, tip_rows


def tip_section(result: Result) -> str:
    """Return the means of K at the tip, empty where it was not measured."""
    found = tip_rows(result.outcomes, [state.name for state in result.scene.states])
    if not found:
        return ""
    rows = [
        [
            state_label(row.state),
            f"{delta_k_in_mpa_sqrt_m(row.delta_k):g}",
            _with_interval(row.k_1),
            _with_interval(row.k_2),
            f"{100.0 * row.measured:.0f} %",
            str(row.cracks),
        ]
        for row in found
    ]
    note = (
        "K at the crack tips, measured on the elements round them, over the ΔK asked for: means over "
        "cracks, weighted by the growth, with 95 % intervals. Values below 1 come from unbroken "
        "ligaments behind the tip, deflection and branches, which take load off it; values above 1 "
        "from interfaces that are already broken ahead of it. The means rest on the growth during "
        f"which the field was that of a single crack tip (misfit at most {MOST_MISFIT:g}); the last "
        "columns say which share of the growth that is, and in how many cracks."
    )
    head = ["State", "ΔK [MPa√m]", "K_I/ΔK", "|K_II|/ΔK", "Measured", "Cracks"]
    return "<h3>K at the tip</h3>" + paragraph(note) + table(head, rows)


def _with_interval(estimate: Estimate) -> str:
    if estimate.low != estimate.low:
        return f"{estimate.value:.2f}"
    return f"{estimate.value:.2f} ({estimate.low:.2f} to {estimate.high:.2f})"
