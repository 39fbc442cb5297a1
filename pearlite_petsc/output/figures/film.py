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
from pearlite_petsc.output.figures.style import INK
from pearlite_petsc.output.snapshot import Snapshot
from pearlite_petsc.output.whole_file import whole_file
from pearlite_petsc.scene import Kind

FRAMES_A_SECOND = 8
OPEN_SHARE = 0.15
"""How far the faces part at most in the picture, as a share of its height."""

_HOLD = 8
"""Times the last frame is shown, so that a loop pauses on the grown crack."""


def animate(steps: Sequence[Snapshot], path: Path, title: str = "") -> Path:
    """Write the film of a crack: damage and broken interfaces, and beside it how the crack opens.

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
        figure = Figure(figsize=(9.6, 4.8 * (top - bottom) / (right - left) + 0.4), dpi=110)
        FigureCanvasAgg(figure)
        panels = [figure.add_axes((x, 0.01, 0.485, 0.88)) for x in (0.01, 0.505)]
        times = magnification(steps[-1], (left, right, bottom, top))
        # The writers choose the format by the suffix, which the partial file does not have.
        named = partial.with_name(partial.name + path.suffix)
        try:
            with writer.saving(figure, str(named), dpi=110):
                for step in [*steps, *[steps[-1]] * _HOLD]:
                    for axes, deformed in zip(panels, (False, True), strict=True):
                        axes.clear()
                        show_damage(axes, step, deformed, times)
                        # A film has few colours, and white would be lost beside the elements'.
                        behind = INK if deformed else "white"
                        axes.set(xlim=(left, right), ylim=(bottom, top), facecolor=behind)
                    text = (
                        f"{title}  {step.cycles:,.0f} cycles, furthest break {step.length:.1f} µm"
                    )
                    panels[0].set_title(text.strip(), fontsize=10, loc="left")
                    panels[1].set_title(f"displacements × {times:g}", fontsize=10, loc="left")
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


def magnification(last: Snapshot, extent: tuple[float, float, float, float]) -> float:
    """Return the factor 1, 2, 5, 10, ... on displacements at which a film shows the crack open.

    Args:
        last: The last step, in which displacements are largest.
        extent: What the film shows of the window: left, right, bottom, top [um].
    """
    left, right, bottom, top = extent
    x, y = last.points.T
    inside = (x >= left) & (x <= right) & (y >= bottom) & (y <= top)
    lift = last.displacement[inside, 1]
    spread = float(np.ptp(lift)) if len(lift) else 0.0
    if spread <= 0.0:
        return 1.0
    wanted = max(OPEN_SHARE * (top - bottom) / spread, 1.0)
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step * power <= wanted))
