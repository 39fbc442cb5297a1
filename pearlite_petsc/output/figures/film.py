"""Film of a growing crack: GIF through Pillow, MP4 where ffmpeg is present."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.animation import FFMpegWriter, PillowWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from pearlite_petsc.errors import SceneError
from pearlite_petsc.output.figures.cracks import show_damage
from pearlite_petsc.output.snapshot import Snapshot
from pearlite_petsc.output.whole_file import whole_file
from pearlite_petsc.scene import Kind

FRAMES_A_SECOND = 8
_HOLD = 8
"""Times the last frame is shown, so that a loop pauses on the grown crack."""


def animate(steps: Sequence[Snapshot], path: Path, title: str = "") -> Path:
    """Write the film of a crack; each frame shows damage, broken interfaces and the cycles.

    Args:
        steps: In order of time.
        path: ``.gif`` or ``.mp4``.
        title: What grows.

    Returns:
        The file written.

    Raises:
        SceneError: No steps, another suffix, or ``.mp4`` without ffmpeg.
    """
    if not steps:
        raise SceneError(f"{path}: a film needs at least one step")
    if path.suffix == ".gif":
        writer: PillowWriter | FFMpegWriter = PillowWriter(fps=FRAMES_A_SECOND)
    elif path.suffix == ".mp4":
        if not FFMpegWriter.isAvailable():
            raise SceneError(f"{path}: an MP4 film needs ffmpeg, which is not installed; use .gif")
        writer = FFMpegWriter(fps=FRAMES_A_SECOND)
    else:
        raise SceneError(f"{path}: a film is .gif or .mp4")
    left, right, bottom, top = view(steps[-1])
    with matplotlib.rc_context({"font.family": "DejaVu Sans"}), whole_file(path) as partial:
        figure = Figure(figsize=(6.4, 6.4 * (top - bottom) / (right - left) + 0.4), dpi=110)
        FigureCanvasAgg(figure)
        axes = figure.add_axes((0.01, 0.01, 0.98, 0.9))
        # The writers choose the format by the suffix, which the partial file does not have.
        named = partial.with_name(partial.name + path.suffix)
        try:
            with writer.saving(figure, str(named), dpi=110):
                for step in [*steps, *[steps[-1]] * _HOLD]:
                    axes.clear()
                    show_damage(axes, step, deformed=False)
                    axes.set(xlim=(left, right), ylim=(bottom, top))
                    text = (
                        f"{title}  {step.cycles:,.0f} cycles, furthest break {step.length:.1f} µm"
                    )
                    axes.set_title(text.strip(), fontsize=10, loc="left")
                    writer.grab_frame()
            named.replace(partial)
        finally:
            named.unlink(missing_ok=True)
    return path


def view(last: Snapshot, margin: float = 12.0) -> tuple[float, float, float, float]:
    """Return the part of the window round the crack: left, right, bottom, top [um].

    At least as high as half its width, so that a straight crack is not a thin strip.
    """
    broken = last.segments[last.broken]
    notch = last.segments[last.kind == Kind.NOTCH]
    ends = np.concatenate([broken, notch]).reshape(-1, 2)
    if not len(ends):
        ends = last.points
    tip = notch.reshape(-1, 2)[:, 0].max() if len(notch) else ends[:, 0].min()
    left, right = (
        max(float(tip) - margin, last.points[:, 0].min()),
        float(ends[:, 0].max()) + margin,
    )
    bottom, top = float(ends[:, 1].min()) - margin, float(ends[:, 1].max()) + margin
    missing = max(0.0, 0.5 * (right - left) - (top - bottom))
    return left, right, bottom - 0.5 * missing, top + 0.5 * missing
