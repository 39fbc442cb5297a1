"""Results of a run: rates, cracks and paths as tables, and the growth rates as a picture."""

from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pearlite_petsc import config
from pearlite_petsc.errors import SceneError
from pearlite_petsc.face.crack import Crack
from pearlite_petsc.face.scene import Files, Scene, found_laws
from pearlite_petsc.face.table import Table
from pearlite_petsc.laws.catalogue import Laws
from pearlite_petsc.output.result_folder import Result, read_result
from pearlite_petsc.output.statistics import rate_curves
from pearlite_petsc.output.tables import UM_PER_M, delta_k_in_mpa_sqrt_m, in_order

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Results:
    """The results of a run, as returned by ``read_results`` and ``run``; iterating gives the cracks.

    Attributes:
        folder: The output folder.
        scene: The scene that was computed.
        provenance: What ran, where and when; empty if only the tables are left.
    """

    def __init__(self, result: Result, laws: Laws | None = None) -> None:
        self.folder, self.provenance = result.folder, result.provenance
        if laws is None:
            # Readable without the laws that it names, which need not be at hand any more.
            self.scene = Scene._of(result.scene, config.laws_of_results(result.scene_text))
        else:
            program = config.load_scene_text(result.scene_text, result.scene.name, (), laws)
            self.scene = Scene._of(program, laws)
        self._measured = result.measured
        self._outcomes = in_order(result.outcomes, list(self.scene.states))
        self._cracks = [Crack._of(self.scene, outcome) for outcome in self._outcomes]

    def cracks(self) -> Table:
        """Return one row per crack, by state, mesh and Delta-K, failed and arrested ones included.

        Columns: ``state``, ``mesh``, ``delta_k_mpa_sqrt_m``, ``da_dn_m_per_cycle`` (NaN where
        there is no rate), ``cycles``, ``extension_um``, ``tortuosity``, ``stop_reason``,
        ``solves``, ``wall_s``.
        """
        same = ("delta_k_mpa_sqrt_m", "da_dn_m_per_cycle", "cycles", "extension_um", "tortuosity")
        more = ("stop_reason", "solves", "wall_s")
        names = {"state": "state", "mesh": "index"} | {name: name for name in (*same, *more)}
        return Table(
            {
                column: [getattr(crack, name) for crack in self._cracks]
                for column, name in names.items()
            }
        )

    def rates(self) -> Table:
        """Return the mean growth rates, one row per state and Delta-K.

        Columns: ``state``, ``delta_k_mpa_sqrt_m``, ``da_dn_m_per_cycle`` (geometric mean over the
        meshes whose cracks grew to the wanted extension; NaN if none did), ``scatter`` (geometric
        standard deviation, a factor; NaN for fewer than two), ``grown`` and ``meshes`` (how many
        cracks grew, of how many). Where not all of them grew, the mean is that of the fast ones.
        """
        curves = rate_curves(self._outcomes, list(self.scene.states))
        counts = [len(curve.delta_k) for curve in curves]
        levels = [delta_k_in_mpa_sqrt_m(level) for curve in curves for level in curve.delta_k]
        return Table(
            {
                "state": np.repeat([curve.state for curve in curves], counts),
                "delta_k_mpa_sqrt_m": levels,
                "da_dn_m_per_cycle": _joined([curve.mean / UM_PER_M for curve in curves]),
                "scatter": _joined([curve.factor for curve in curves]),
                "grown": _joined([curve.grown for curve in curves]),
                "meshes": _joined([curve.tasks for curve in curves]),
            }
        )

    def paths(self) -> Table:
        """Return the paths of all cracks, one row per vertex, from the notch to the tip.

        Columns: ``state``, ``mesh``, ``delta_k_mpa_sqrt_m``, ``x_um``, ``y_um``.
        """
        cracks = self._cracks
        counts = [len(crack.path) for crack in cracks]
        return Table(
            {
                "state": np.repeat([crack.state for crack in cracks], counts),
                "mesh": np.repeat([crack.index for crack in cracks], counts),
                "delta_k_mpa_sqrt_m": np.repeat(
                    [crack.delta_k_mpa_sqrt_m for crack in cracks], counts
                ),
                "x_um": _joined([crack.path.x_um for crack in cracks]),
                "y_um": _joined([crack.path.y_um for crack in cracks]),
            }
        )

    def crack(self, state: str, index: int = 0, *, delta_k_mpa_sqrt_m: float) -> Crack:
        """Return one crack with its history and path.

        Args:
            state: Name of the state.
            index: Number of the mesh.
            delta_k_mpa_sqrt_m: Range of the stress intensity factor [MPa sqrt(m)].

        Raises:
            PearliteError: There is no such crack; the message says which there are.
        """
        config.state_named(self.scene._program, state)
        own = [crack for crack in self._cracks if crack.state == state]
        for crack in own:
            if crack.index == index and np.isclose(
                crack.delta_k_mpa_sqrt_m, delta_k_mpa_sqrt_m, rtol=1e-9
            ):
                return crack
        meshes = ", ".join(map(str, sorted({crack.index for crack in own})))
        levels = ", ".join(f"{value:g}" for value in sorted({c.delta_k_mpa_sqrt_m for c in own}))
        wanted = f"no crack of {state}, mesh {index}, at {delta_k_mpa_sqrt_m:g} MPa sqrt(m)"
        raise SceneError(f"{self.folder}: {wanted}; meshes are {meshes or '-'}, at {levels or '-'}")

    def to_dict(self) -> dict[str, Any]:
        """Return the columns of ``cracks``, as ``pandas.DataFrame`` takes them."""
        return self.cracks().to_dict()

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw da/dN over Delta-K with the scatter from mesh to mesh; return the axes.

        The measured points that the scene names are drawn, too.

        Args:
            ax: Where to draw; a new figure's if None.
        """
        from pearlite_petsc.output.figures.rates import show_rates
        from pearlite_petsc.output.figures.style import on_axes

        with on_axes(ax, height=5.4) as axes:
            states = self.scene._program.states
            show_rates(axes, self._outcomes, states, self._measured, room_below=ax is None)
        return axes

    def __len__(self) -> int:
        return len(self._cracks)

    def __iter__(self) -> Iterator[Crack]:
        return iter(self._cracks)

    def __repr__(self) -> str:
        reasons = [crack.stop_reason for crack in self._cracks]
        counts = ", ".join(f"{reasons.count(name)} {name}" for name in sorted(set(reasons)))
        return f"<Results of {self.folder}: {len(self)} cracks, {counts or 'none yet'}>"


def read_results(path: str | PathLike[str], *, load: Files = ()) -> Results:
    """Read the results of a run.

    Args:
        path: The run's output folder, or its ``results.h5``.
        load: A Python file, or several, with the laws of your own that the run used; needed only
            to grow further cracks with its scene.

    Raises:
        PearliteError: There are no results, a file cannot be read, or the text of a law has
            changed.
    """
    return Results(read_result(Path(path)), found_laws(load) if load else None)


def _joined(arrays: list[Any]) -> Any:
    return np.concatenate(arrays) if arrays else np.empty(0)
