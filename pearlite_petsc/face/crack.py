"""One crack with its history and path, grown here or read from a run."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pearlite_petsc import config
from pearlite_petsc.errors import PearliteError
from pearlite_petsc.face.scene import Scene
from pearlite_petsc.face.table import Table
from pearlite_petsc.fatigue.growth_rate import advances, incremental_polynomial, secant
from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.output.tables import (
    GROWTH_COLUMNS,
    UM_PER_M,
    delta_k_in_mpa_sqrt_m,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Crack:
    """A crack that was grown: its growth rate, history and path, and why it ended.

    Attributes:
        scene: The scene that it was grown with.
        state: Name of the state.
        index: Number of the mesh.
        delta_k_mpa_sqrt_m: Range of the stress intensity factor [MPa sqrt(m)].
        stop_reason: Why it ended: "grown" (reached the wanted extension), "arrested", "boundary"
            (reached the window's edge), "max_solves", "left_refined_zone" or "failed"; "stopped"
            if the steps of a ``Growth`` were not taken to the end.
        da_dn_m_per_cycle: Least-squares slope of the crack length over the cycles at which it
            grew [m/cycle]; NaN if nothing grew or the crack arrested.
        cycles: Number of cycles N at the end.
        extension_um: Growth along x [um].
        tortuosity: Path length over extension; NaN if the extension is below one colony.
        history: One row per break: ``cycles``, ``crack_length_um`` (notch included),
            ``path_length_um``, ``broken_interfaces``, and ``k_1_over_delta_k``,
            ``k_2_over_delta_k`` and ``k_misfit`` as measured at the tip (NaN where they were not).
        path: Vertices of the path from the notch to the tip: ``x_um``, ``y_um``.
        solves: Number of linear solves.
        wall_s: Wall time [s].
        message: Error message if the crack failed, otherwise empty.
    """

    scene: Scene
    state: str
    index: int
    delta_k_mpa_sqrt_m: float
    stop_reason: str
    da_dn_m_per_cycle: float
    cycles: float
    extension_um: float
    tortuosity: float
    history: Table
    path: Table
    solves: int
    wall_s: float
    message: str

    @classmethod
    def _of(cls, scene: Scene, outcome: Outcome, finished: bool = True) -> "Crack":
        history = np.empty((0, len(GROWTH_COLUMNS))) if outcome.history is None else outcome.history
        path = np.empty((0, 2)) if outcome.shape is None else outcome.shape.path
        return cls(
            scene=scene,
            state=outcome.state,
            index=outcome.mesh_index,
            delta_k_mpa_sqrt_m=delta_k_in_mpa_sqrt_m(outcome.delta_k),
            stop_reason=outcome.stop_reason.value if finished else "stopped",
            da_dn_m_per_cycle=float(outcome.da_dn) / UM_PER_M,
            cycles=float(outcome.cycles),
            extension_um=float(outcome.extension),
            tortuosity=np.nan if outcome.tortuosity is None else float(outcome.tortuosity),
            history=Table(
                {
                    "cycles": history[:, 0],
                    "crack_length_um": history[:, 1],
                    "path_length_um": history[:, 2],
                    "broken_interfaces": history[:, 3].astype(np.int64),
                    "k_1_over_delta_k": history[:, 4],
                    "k_2_over_delta_k": history[:, 5],
                    "k_misfit": history[:, 6],
                }
            ),
            path=Table({"x_um": path[:, 0], "y_um": path[:, 1]}),
            solves=outcome.effort.solves,
            wall_s=float(outcome.effort.wall_s),
            message=outcome.message,
        )

    @property
    def rates(self) -> Table:
        """Growth rates point by point, one row each time the crack got longer, as in ``da_dn.csv``.

        The columns are ``cycles``, ``crack_length_um``, and da/dN there by two methods of ASTM
        E647: ``secant_m_per_cycle`` of the step that ended there, and ``polynomial_m_per_cycle``
        of the parabola fitted to the seven points round it; NaN where a method gives no rate.
        """
        history = self.history
        # A failed crack has no row at all.
        chosen = advances(history.crack_length_um)[: len(history)]
        cycles, length = history.cycles[chosen], history.crack_length_um[chosen]
        return Table(
            {
                "cycles": cycles,
                "crack_length_um": length,
                "secant_m_per_cycle": secant(cycles, length) / UM_PER_M,
                "polynomial_m_per_cycle": incremental_polynomial(cycles, length) / UM_PER_M,
            }
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the history as ``pandas.DataFrame`` takes it, with the crack named in every row.

        The tables of several cracks can thus be concatenated.
        """
        rows = len(self.history)
        return {
            "state": np.repeat(self.state, rows),
            "mesh": np.repeat(self.index, rows),
            "delta_k_mpa_sqrt_m": np.repeat(self.delta_k_mpa_sqrt_m, rows),
            **self.history.to_dict(),
        }

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the crack's path in its microstructure; return the axes.

        Args:
            ax: Where to draw; a new figure's if None.

        Raises:
            PearliteError: There is no path, because the crack failed or was read from tables alone.
        """
        from pearlite_petsc.output.draw import show_path
        from pearlite_petsc.output.figures.style import on_axes

        if not len(self.path):
            raise PearliteError(f"{self!r} has no path to draw")
        program = self.scene._program
        state = config.state_named(program, self.state)
        path = np.column_stack([self.path.x_um, self.path.y_um])
        with on_axes(ax) as axes:
            show_path(axes, program, state, self.index, path, self.delta_k_mpa_sqrt_m)
        return axes

    def plot_history(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the crack length over the cycles and the line whose slope is da/dN; return the axes.

        Args:
            ax: Where to draw; a new figure's if None.
        """
        from pearlite_petsc.output.figures.growth import show_history
        from pearlite_petsc.output.figures.style import on_axes, state_label

        name = f"{state_label(self.state)}, mesh {self.index}"
        label = f"{name}, ΔK = {self.delta_k_mpa_sqrt_m:g} MPa√m"
        rate = self.da_dn_m_per_cycle * UM_PER_M
        with on_axes(ax) as axes:
            show_history(axes, self.history.cycles, self.history.crack_length_um, label, rate)
        return axes

    def __repr__(self) -> str:
        name = f"{self.state} {self.index} at {self.delta_k_mpa_sqrt_m:g} MPa sqrt(m)"
        what = f"{self.stop_reason}, {self.extension_um:.1f} um in {self.cycles:,.0f} cycles"
        return f"<Crack {name}: {what}, {self.da_dn_m_per_cycle:.3g} m/cycle>"
