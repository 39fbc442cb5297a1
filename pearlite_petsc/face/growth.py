"""Growing one crack, whole or step by step, on one rank or shared by several."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from types import TracebackType
from typing import TYPE_CHECKING

from pearlite_petsc import config
from pearlite_petsc.errors import PearliteError, SceneError
from pearlite_petsc.face.crack import Crack
from pearlite_petsc.face.mesh import Mesh
from pearlite_petsc.face.scene import Scene
from pearlite_petsc.fatigue.outcome import StopReason
from pearlite_petsc.growth.prepared import Prepared
from pearlite_petsc.mechanics.elasticity import ratio_of_mesh
from pearlite_petsc.scene import Scene as ProgramScene
from pearlite_petsc.scene import State
from pearlite_petsc.world import world

if TYPE_CHECKING:
    from mpi4py import MPI

MADE_FROM = ("microstructure", "window", "elements")
"""Tables of a scene that a mesh follows from, beside the shear of its state."""


@dataclass(frozen=True, slots=True)
class Step:
    """The position of a growing crack after a block of cycles.

    Attributes:
        cycles: Number of cycles N so far.
        crack_length_um: Furthest x of the crack, notch included [um].
        solves: Number of linear solves so far.
        stop_reason: Why the crack ended, as in ``Crack.stop_reason``; None while it grows.
    """

    cycles: float
    crack_length_um: float
    solves: int
    stop_reason: str | None


class Growth(Iterator[Step]):
    """One growing crack: an iterator over its steps, and a context manager that frees its solver.

    Collective: under ``mpirun`` all ranks of ``comm`` make it and take its steps together. The
    last step frees the solver; if you stop earlier, leave the ``with`` block or call ``close``.

    Args:
        mesh: The mesh that the crack grows on, from its notch.
        delta_k_mpa_sqrt_m: Range of the stress intensity factor [MPa sqrt(m)].
        scene: The scene whose law, load and solver to use, if not the mesh's own; it must have
            the same microstructure, window and elements, and the mesh's state.
        comm: Ranks that share the crack; all ranks if None.

    Raises:
        PearliteError: Delta-K is outside its limits, or the mesh does not belong to ``scene``.

    Examples:
        >>> scene = Scene(loading={"extension_um": 20.0})
        >>> with Growth(build_mesh(scene, "severe_AT"), delta_k_mpa_sqrt_m=18.0) as growth:
        ...     for step in growth:
        ...         if step.crack_length_um > 90.0:
        ...             break
        ...     crack = growth.crack()
        >>> crack.stop_reason
        'stopped'
    """

    def __init__(
        self,
        mesh: Mesh,
        *,
        delta_k_mpa_sqrt_m: float,
        scene: Scene | None = None,
        comm: "MPI.Comm | None" = None,
    ) -> None:
        if not isinstance(mesh, Mesh):
            raise TypeError(f"a mesh of build_mesh is needed, got {type(mesh).__name__}")
        self.mesh = mesh
        wanted = mesh.scene if scene is None else scene
        self.scene = wanted.replace(loading={"delta_k_mpa_sqrt_m": [delta_k_mpa_sqrt_m]})
        program = self.scene._program
        state, prepared = _on_mesh(program, mesh)
        # Here, so that asking for the class starts neither MPI nor PETSc.
        from pearlite_petsc.growth.loop import CrackGrowth

        self._comm = world() if comm is None else comm
        first = prepared if self._comm.rank == 0 else None
        self._growth = CrackGrowth(self._comm, program, state, program.loading.delta_k[0], first)
        self._steps = self._growth.steps()
        self._crack: Crack | None = None
        self._is_open = True

    def __next__(self) -> Step:
        if not self._is_open:
            raise StopIteration
        try:
            step = next(self._steps)
        except BaseException:
            self._free()
            raise
        if step.stop is not None:
            self._crack = self._crack_now(step.stop)
            self._free()
        stop = None if step.stop is None else step.stop.value
        return Step(step.cycles, step.crack_length, step.solves, stop)

    def crack(self) -> Crack:
        """Return the crack as it is now, or as it was when the growth ended. Collective."""
        return self._crack_now(None) if self._is_open else self._kept()

    def close(self) -> None:
        """Free the solver and keep the crack as it is. Collective; may be called again."""
        if self._is_open:
            self._crack = self._crack_now(None)
            self._free()

    def __enter__(self) -> "Growth":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is None:
            self.close()
        self._free()

    def __repr__(self) -> str:
        where = "growing" if self._is_open else "ended"
        delta_k = self.scene["loading"]["delta_k_mpa_sqrt_m"][0]
        return (
            f"<Growth on {self.mesh.state} {self.mesh.index} at {delta_k:g} MPa sqrt(m), {where}>"
        )

    def _free(self) -> None:
        if self._is_open:
            self._is_open = False
            self._growth.close()

    def _crack_now(self, stop: StopReason | None) -> Crack:
        outcome = self._comm.bcast(self._growth.outcome(stop or StopReason.GROWN))
        return Crack._of(self.scene, outcome, finished=stop is not None)

    def _kept(self) -> Crack:
        if self._crack is None:
            raise PearliteError("this growth ended with an error and has no crack")
        return self._crack


def grow_crack(
    mesh: Mesh,
    *,
    delta_k_mpa_sqrt_m: float,
    scene: Scene | None = None,
    comm: "MPI.Comm | None" = None,
) -> Crack:
    """Grow a crack from the notch of a mesh until it ends. Collective over ``comm``.

    Args:
        mesh: The mesh that the crack grows on.
        delta_k_mpa_sqrt_m: Range of the stress intensity factor [MPa sqrt(m)].
        scene: The scene whose law, load and solver to use, if not the mesh's own; as for
            ``Growth``.
        comm: Ranks that share the crack; all ranks if None.

    Returns:
        The crack with its growth rate, history and path.

    Raises:
        PearliteError: As for ``Growth``, or no equilibrium was found.

    Examples:
        >>> mesh = build_mesh(Scene(loading={"extension_um": 5.0}), "severe_AT")
        >>> crack = grow_crack(mesh, delta_k_mpa_sqrt_m=18.0)
        >>> crack.history.columns
        ('cycles', 'crack_length_um', 'path_length_um', 'broken_interfaces', 'k_1_over_delta_k', 'k_2_over_delta_k', 'k_misfit')
        >>> faster = mesh.scene.replace(damage={"c_um5_per_n2": 2 * 4410.0})
        >>> twice = grow_crack(mesh, delta_k_mpa_sqrt_m=18.0, scene=faster)
        >>> round(twice.da_dn_m_per_cycle / crack.da_dn_m_per_cycle, 6)
        2.0
    """
    with Growth(mesh, delta_k_mpa_sqrt_m=delta_k_mpa_sqrt_m, scene=scene, comm=comm) as growth:
        for _ in growth:
            pass
        return growth.crack()


def _on_mesh(scene: ProgramScene, mesh: Mesh) -> tuple[State, Prepared]:
    """Return the mesh's state in a scene, and the mesh ready for that scene's springs.

    Raises:
        SceneError: The scene has no such state, or makes another mesh of it.
    """
    own, prepared = mesh.scene._program, mesh._prepared
    state, before = (config.state_named(one, mesh.state) for one in (scene, own))
    same_shear = (state.shear_strain, state.orientation) == (
        before.shear_strain,
        before.orientation,
    )
    other = [f"[{name}]" for name in MADE_FROM if getattr(scene, name) != getattr(own, name)]
    other += [] if same_shear else [f"[states.{mesh.state}]"]
    if other:
        text = f"{other[0]} is not the one that mesh {mesh.state} {mesh.index} was made from"
        raise SceneError(f"scene {scene.name}: {text}; build_mesh makes one of this scene")
    if scene.material != own.material:
        prepared = replace(prepared, ratio=ratio_of_mesh(prepared.mesh, scene.material))
    return state, prepared
