"""What the growth of one crack yields: states on the way, and the outcome of the task."""

from dataclasses import dataclass, field
from enum import Enum

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.tessellation.mesh import Mesh


class StopReason(str, Enum):
    """Why a task ended."""

    GROWN = "grown"
    ARRESTED = "arrested"
    LEFT_REFINED_ZONE = "left_refined_zone"
    BOUNDARY = "boundary"
    MAX_SOLVES = "max_solves"
    FAILED = "failed"


@dataclass(frozen=True, slots=True, eq=False)
class Crack:
    """The crack's measures: broken interfaces connected to the notch.

    Attributes:
        length: Furthest x of the crack [um], notch included.
        tip: Where that is [um].
        path: Vertices of the shortest way along broken interfaces from the notch's tip to the
            crack's tip [um]; (p, 2), p >= 1.
        path_length: Length of that way [um].
        broken: Broken interfaces, connected or not.
    """

    length: float
    tip: tuple[float, float]
    path: FloatArray
    path_length: float
    broken: int


@dataclass(frozen=True, slots=True)
class Step:
    """Where a crack stands after a block.

    Attributes:
        cycles: N [cycles].
        crack_length: Furthest x [um].
        solves: Linear solves so far.
        stop: Why the task ended, None while it goes on.
    """

    cycles: float
    crack_length: float
    solves: int
    stop: StopReason | None


@dataclass(frozen=True, slots=True, eq=False)
class GrowthState:
    """A crack at one moment: after a solve, before the block of cycles that follows from it.

    Attributes:
        mesh: The mesh of this moment (refinement replaces it; same object while it stays).
        cycles: N so far.
        crack: The crack's measures.
        displacement: Rigid motions (X, Y, theta) under delta_k [um, um, rad]; (n, 3).
        damage: D of each interface, 1 for the notch's; (k,).
        normal_stress, shear_stress: Ranges that drive the damage [MPa], 0 where broken; (k,).
        failure_cycles: N at which an interface broke, NaN where it has not, 0 the notch's; (k,).
        loose: Elements of clusters that hang on no load-bearing interface; (n,).
        solves: Linear solves so far.
    """

    mesh: Mesh
    cycles: float
    crack: Crack
    displacement: FloatArray
    damage: FloatArray
    normal_stress: FloatArray
    shear_stress: FloatArray
    failure_cycles: FloatArray
    loose: BoolArray
    solves: int


@dataclass(frozen=True, slots=True)
class Effort:
    """What a task cost.

    Attributes:
        solves, refinements: Linear solves, meshes replaced on the way.
        counters: Fallbacks and iterations of the solver ("iterations", "setups", "refreshed",
            "direct", "loose_elements", ...).
        wall_s: Wall time [s].
        elements: Elements of the last mesh.
    """

    solves: int = 0
    refinements: int = 0
    counters: dict[str, float] = field(default_factory=dict)
    wall_s: float = 0.0
    elements: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class CrackShape:
    """What a crack looks like at the end.

    Attributes:
        path: Crack path [um]; (p, 2).
        broken_pairs: Nuclei of the two elements of each broken interface, notch excluded, sorted;
            (b, 2). Equal for the same crack on differently graded meshes.
    """

    path: FloatArray
    broken_pairs: IntArray


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """Result of one task.

    Attributes:
        state, mesh_index, delta_k: The task [-, -, MPa sqrt(um)].
        stop_reason: Why it ended.
        message: Error message of a failed task, else empty.
        cycles: N at the end.
        extension: Crack growth [um].
        da_dn: Slope of crack length over cycles [um/cycle], NaN where nothing grew or the crack
            arrested.
        tortuosity: Path length over x-extent, None where the extent is below one colony.
        history: Columns cycles, crack_length, path_length, broken_interfaces, K_I and K_II at the
            tip over Delta-K and the misfit of their measurement, NaN where there is none; (h, 7).
        effort: What it cost.
        shape: What the crack looks like at the end, None where a task failed or where only a table
            is left of it.
    """

    state: str
    mesh_index: int
    delta_k: float
    stop_reason: StopReason
    message: str = ""
    cycles: float = 0.0
    extension: float = 0.0
    da_dn: float = float("nan")
    tortuosity: float | None = None
    history: FloatArray | None = None
    effort: Effort = field(default_factory=Effort)
    shape: CrackShape | None = None
