"""Figures of forty Delta-K can be read: nothing is cut off, and no number lies on another."""

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pearlite_petsc.output.draw import Result, figure_jobs
from pearlite_petsc.output.figures import style
from tests.output import synthetic
from tests.scenes import STATES, default_scene

FORTY = tuple(1e3 * np.arange(6.0, 46.0))


def drawn(
    levels: tuple[float, ...], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> dict[str, Any]:
    """Return the figures by name, drawn and laid out; a warning is an error here."""
    scene = default_scene(
        states=(STATES["undeformed"], STATES["severe_AT"]), loading={"delta_k": levels}
    )
    tasks = [
        o for o in synthetic.outcomes(levels, meshes=2) if o.state in ("undeformed", "severe_AT")
    ]
    figures: dict[str, Any] = {}
    with monkeypatch.context() as patch:
        patch.setattr(
            style, "_write", lambda figure, path, cut: figures.update({path.name: figure})
        )
        for name, job in figure_jobs(Result(folder, scene, tasks)):
            if name in ("fcg", "growth", "null_model", "tortuosity", "path_undeformed"):
                job()
    assert figures.keys() == {"fcg", "growth", "null_model", "tortuosity", "path_undeformed"}
    return figures


def boxes(figure: Any, texts: Any) -> list[Any]:
    renderer = figure.canvas.get_renderer()
    return [
        text.get_window_extent(renderer) for text in texts if text.get_visible() and text.get_text()
    ]


@pytest.mark.parametrize("levels", [FORTY, FORTY[:4], (1e3, 10e3, 200e3), (12e3, 12.5e3, 13e3)])
def test_nothing_is_cut_off_and_no_number_lies_on_another(
    levels: tuple[float, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, figure in drawn(levels, tmp_path, monkeypatch).items():
        if name == "path_undeformed":
            (legend,) = [a.get_legend() for a in figure.axes if a.get_legend()]
            assert len(legend.get_texts()) <= style.MOST_NAMED + 2
            continue
        whole = figure.bbox.padded(1.0)
        for axes in figure.axes:
            ticks = boxes(figure, axes.get_xticklabels())
            inside = [
                box
                for box in ticks
                if axes.bbox.x0 - 1 <= 0.5 * (box.x0 + box.x1) <= axes.bbox.x1 + 1
            ]
            for left, right in pairwise(inside):
                assert not left.overlaps(right), name
            for box in [*inside, *boxes(figure, [axes.yaxis.label, axes.xaxis.label, axes.title])]:
                assert whole.x0 <= box.x0 and box.x1 <= whole.x1, name
                assert whole.y0 <= box.y0 and box.y1 <= whole.y1, name
        for legend in figure.legends:
            box = legend.get_window_extent()
            assert whole.x0 <= box.x0 and box.x1 <= whole.x1 and whole.y0 <= box.y0, name
