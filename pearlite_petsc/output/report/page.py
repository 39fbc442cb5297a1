"""``report.html``: one self-contained page about a result."""

from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any

from pearlite_petsc.config import method_warnings
from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.output.figures.style import state_label
from pearlite_petsc.output.report.conclusions import conclusions
from pearlite_petsc.output.report.elements import (
    STYLE,
    bullets,
    folded,
    paragraph,
    picture,
    table,
)
from pearlite_petsc.output.report.reproduce import how_made, when
from pearlite_petsc.output.report.tip import tip_section
from pearlite_petsc.output.report.validity import task_warnings, validity_warnings, zone_rows
from pearlite_petsc.output.result_folder import Result
from pearlite_petsc.output.statistics import rate_curves
from pearlite_petsc.output.tables import UM_PER_M, delta_k_in_mpa_sqrt_m, in_order
from pearlite_petsc.output.whole_file import whole_file


def write_report(
    path: Path, result: Result, scene_text: str, provenance: Mapping[str, Any]
) -> None:
    """Write the page with the figures found in ``<result>/figures`` inlined.

    Args:
        path: ``report.html``.
        result: Scene and outcomes.
        scene_text: The resolved scene (TOML).
        provenance: What ran, where and when.
    """
    sections = [
        ("Growth rates", _rates(result)),
        ("What the source concludes", _conclusions(result)),
        ("Warnings", _warnings(result)),
        ("Crack paths", _paths(result)),
        ("Growth of the cracks", _growth(result)),
        ("Microstructure and mesh", _microstructure(result)),
        ("All tasks", _tasks(result)),
        ("How this was made", how_made(result.folder, scene_text, provenance)),
    ]
    links = "".join(f'<a href="#s{i}">{escape(t)}</a>' for i, (t, _) in enumerate(sections))
    body = "".join(
        f'<section id="s{i}"><h2>{escape(title)}</h2>{content}</section>'
        for i, (title, content) in enumerate(sections)
    )
    name = escape(result.scene.name)
    page = (
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{name}: fatigue crack growth in pearlite</title><style>{STYLE}</style></head>"
        f"<body><h1>Fatigue crack growth in pearlite: {name}</h1>{_summary(result, provenance)}"
        f"<nav>{links}</nav>{body}</body></html>\n"
    )
    with whole_file(path) as partial:
        partial.write_text(page, encoding="utf-8")


def _summary(result: Result, provenance: Mapping[str, Any]) -> str:
    scene, outcomes = result.scene, result.outcomes
    grown = sum(o.stop_reason is StopReason.GROWN for o in outcomes)
    levels = ", ".join(f"{delta_k_in_mpa_sqrt_m(value):g}" for value in scene.loading.delta_k)
    window, elements, loading = scene.window, scene.elements, scene.loading
    text = (
        f"{_counted(len(outcomes), 'crack', 'cracks')} "
        f"({_counted(len(scene.states), 'state', 'states')} × "
        f"{_counted(scene.ensemble.meshes, 'mesh', 'meshes')} × "
        f"{len(scene.loading.delta_k)} ΔK in the scene), {grown} of them grown by the "
        f"wanted {loading.extension:g} µm. ΔK = {levels} MPa√m; window {window.width:g} × "
        f"{window.height:g} µm, notch {window.notch:g} µm, elements {elements.width:g} × "
        f"{elements.length:g} µm; {scene.material.springs} springs, {scene.damage.law} damage law, "
        f"{loading.kind} load."
    )
    return paragraph(text, "lead") + paragraph(when(provenance))


def _counted(number: int, one: str, more: str) -> str:
    return f"{number} {one if number == 1 else more}"


def _figure(result: Result, name: str, caption: str) -> str:
    return picture(result.folder / "figures" / f"{name}.png", caption, f"figures/{name}.png")


def _rates(result: Result) -> str:
    curves = rate_curves(result.outcomes, [state.name for state in result.scene.states])
    rows = [
        [
            state_label(curve.state),
            f"{delta_k_in_mpa_sqrt_m(level):g}",
            f"{mean / UM_PER_M:.2e}" if mean == mean else "–",
            f"{factor:.2f}" if factor == factor else "–",
            f"{grown} of {tasks}",
        ]
        for curve in curves
        for level, mean, factor, grown, tasks in zip(
            curve.delta_k, curve.mean, curve.factor, curve.grown, curve.tasks, strict=True
        )
    ]
    head = ["State", "ΔK [MPa√m]", "da/dN [m/cycle]", "Scatter ×/÷", "Grown"]
    note = (
        "da/dN is the slope of crack length over cycles. The mean is the geometric mean over the "
        "meshes whose crack grew to the wanted extension, and the scatter is their geometric "
        "standard deviation. Where not all cracks grew to the end, the mean is that of the fast "
        "ones: its mark is half-filled, and it is not compared with others. A crack that arrested "
        "has no growth rate (arrow at the foot); the rate of a crack that ended otherwise is a "
        "hollow mark and is left out of means."
    )
    caption = (
        "Growth rate over ΔK. Marks: geometric mean with geometric standard deviation over meshes; "
        "half-filled: not all meshes grew; small: single cracks; hollow: ended before the full "
        "extension; arrow at the foot: arrested, no rate; dotted: thresholds; grey: literature."
    )
    null = (
        "Rates relative to the first state, with 95 % intervals, at the ΔK at which every mesh of "
        "both grew; hollow: an upper bound, because some cracks ran into the window's edge. Lines: "
        "what yield stress and threshold alone give, da/dN ∝ (ΔK − ΔK_th)³/σ_yield. The difference "
        "between mark and line is due to the microstructure."
    )
    return (
        _figure(result, "fcg", caption)
        + paragraph(note)
        + table(head, rows)
        + _figure(result, "null_model", null)
    )


def _conclusions(result: Result) -> str:
    if len(result.scene.states) == 1:
        return paragraph(
            "The source's conclusions compare states of the steel; this scene has one, "
            f"{result.scene.states[0].name}."
        )
    rows = [
        [c.statement, c.verdict.value, c.numbers]
        for c in conclusions(result.scene, result.outcomes)
    ]
    intro = (
        "Means over the ΔK at which every mesh of both states grew to the wanted extension, with "
        "95 % intervals over meshes; the number of these ΔK stands beside each mean. Across the "
        "lamellae (T-A), cracks that ran into the window's edge count with their rate until then, "
        "which is an upper bound. Near the threshold, much of a difference is an input, namely "
        "that of the thresholds; the null model says how much."
    )
    return paragraph(intro) + table(["Statement", "Verdict", "Numbers"], rows, numbers_from=3)


def _warnings(result: Result) -> str:
    tasks = task_warnings(result.outcomes, result.scene.elements)
    texts = [*method_warnings(result.scene), *validity_warnings(result.scene)]
    content = bullets(texts, "warning") if texts else ""
    for reason, names in tasks.items():
        content += f"<h3>{escape(f'{len(names)} × {reason}')}</h3>"
        content += bullets(names) if len(names) <= 6 else folded("which", bullets(names))
    if not texts and not tasks:
        content = paragraph("None: every crack grew as wanted, within the model's limits.", "good")
    stress = (
        "Remote stress [MPa]" if result.scene.loading.kind == "edge_crack" else "Edge stress [MPa]"
    )
    head = ["State", "ΔK [MPa√m]", "Plastic zone [µm]", "in colonies", stress, "over yield"]
    rows = [
        [
            state_label(row.state),
            f"{row.delta_k:g}",
            f"{row.plastic_zone:.1f}",
            f"{row.colonies:.1f}",
            f"{row.stress:.0f}",
            f"{row.stress_share:.2f}",
        ]
        for row in zone_rows(result.scene)
    ]
    return content + folded("Plastic zone and nominal stress of every state", table(head, rows))


def _paths(result: Result) -> str:
    parts = [_figure(result, "paths", "Crack paths of all meshes at one ΔK.")]
    for state in result.scene.states:
        caption = (
            f"{state_label(state.name)}, γ = {state.shear_strain:g}: crack paths in the "
            "microstructure of one mesh, and the damage round one of the cracks."
        )
        parts.append(_figure(result, f"path_{state.name}", caption))
    caption = (
        "Tortuosity: path length over extent in x. Filled: cracks that grew to the wanted "
        "extension, over which the mean is taken; hollow: cracks that ended earlier."
    )
    return "".join(parts) + _figure(result, "tortuosity", caption)


def _growth(result: Result) -> str:
    return _figure(result, "growth", "Crack length over cycles, one line per mesh.") + tip_section(
        result
    )


def _microstructure(result: Result) -> str:
    return (
        _figure(
            result,
            "microstructure",
            "Prior austenite grains, blocks and colonies of mesh 0 of each state.",
        )
        + _figure(
            result,
            "lamella_angles",
            "Lamella angles of all meshes, and their closed-form distribution.",
        )
        + _figure(result, "lamella_roses", "The same as rose plots; the crack runs to the right.")
        + _figure(result, "mesh", "Interfaces by kind, at the end of one crack of each state.")
    )


def _tasks(result: Result) -> str:
    names = [state.name for state in result.scene.states]
    head = ["State", "Mesh", "ΔK", "da/dN [m/cycle]", "Cycles", "Extension [µm]", "Tortuosity"]
    head += ["End", "Solves", "Elements", "Time [s]"]
    rows = [_task_row(o) for o in in_order(result.outcomes, names)]
    total = sum(o.effort.wall_s for o in result.outcomes)
    text = f"{len(rows)} cracks, {sum(o.effort.solves for o in result.outcomes)} solves, {total:.1f} s."
    return paragraph(text) + folded("Table of all tasks", table(head, rows))


def _task_row(o: Outcome) -> list[str]:
    return [
        state_label(o.state),
        str(o.mesh_index),
        f"{delta_k_in_mpa_sqrt_m(o.delta_k):g}",
        f"{o.da_dn / UM_PER_M:.3e}" if o.da_dn == o.da_dn else "–",
        f"{o.cycles:.4g}",
        f"{o.extension:.1f}",
        "–" if o.tortuosity is None else f"{o.tortuosity:.2f}",
        o.stop_reason.value.replace("_", " "),
        str(o.effort.solves),
        str(o.effort.elements),
        f"{o.effort.wall_s:.2f}",
    ]
