"""The claims as a table for the terminal and as a Markdown report with figures beside it."""

from collections.abc import Mapping
from pathlib import Path

from pearlite_petsc.output.whole_file import whole_file
from pearlite_petsc.studies.verification.claim import Claim, Section

_HEAD = "| claim | source | expected | measured | tolerance | holds |\n|" + " --- |" * 6
_INTRODUCTION = (
    "Written by `python -m pearlite_petsc.verify`. Every line is computed; a claim that does not "
    "hold is a finding and ends the command with exit status 1."
)


def write_report(path: Path, sections: Mapping[str, Section], effort: str) -> None:
    """Write ``report.md``; figures are linked by name in the same folder.

    Args:
        path: Of the report.
        sections: By name.
        effort: Form of the run, as the reader sees it.
    """
    claims = [claim for section in sections.values() for claim in section.claims]
    failed = [claim for claim in claims if not claim.holds]
    lines = ["# Verification", "", _INTRODUCTION, ""]
    lines += [f"Form: {effort}. Claims: {len(claims)}, of which {len(failed)} do not hold.", ""]
    lines += [f"- does not hold: {claim.statement}" for claim in failed]
    lines += [f"- left out: {text}" for section in sections.values() for text in section.left_out]
    for name, section in sections.items():
        lines += ["", f"## {section.title}", "", f"`--only {name}`", ""]
        if section.claims:
            lines += [_HEAD, *(_row(claim) for claim in section.claims), ""]
        for paragraph in section.text:
            lines += [paragraph, ""]
        for figure, caption in section.figures.items():
            lines += [f"![{caption}]({figure}.png)", "", f"*{caption}*", ""]
    with whole_file(path) as partial:
        partial.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")


def terminal_table(section: Section) -> str:
    """Return a section's claims as lines of plain text."""
    lines = [section.title]
    for claim in section.claims:
        mark = "pass" if claim.holds else "FAIL"
        lines.append(f"  {mark}  {claim.statement}")
        lines.append(
            f"        expected {claim.expected}, measured {claim.measured}, "
            f"tolerance {claim.tolerance}  [{claim.source}]"
        )
    lines += [f"  left out: {text}" for text in section.left_out]
    return "\n".join(lines)


def _row(claim: Claim) -> str:
    cells = (claim.statement, claim.source, claim.expected, claim.measured, claim.tolerance)
    mark = "yes" if claim.holds else "**no**"
    return "| " + " | ".join([*(cell.replace("|", "\\|") for cell in cells), mark]) + " |"
