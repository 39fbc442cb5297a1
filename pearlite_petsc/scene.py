"""Validated scene: what to compute, in the program's units (um, MPa, uN, MPa sqrt(um)).

Plain frozen dataclasses. ``config`` reads them from TOML and is the only place that converts
units; everything else takes them as they are.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Literal

from pearlite_petsc.laws.cycle_jump import CycleJumpLaw
from pearlite_petsc.laws.damage import DamageLaw
from pearlite_petsc.laws.springs import SpringLaw

Orientation = Literal["AT", "TA"]
DrivingStress = Literal["effective", "nominal"]
Threshold = Literal["tip", "remote"]
LoadKind = Literal["k_field", "edge_crack"]
LoadControl = Literal["K", "stress"]
Shear = Literal["remesh", "affine"]
Kinds = Literal["labels", "cut"]


class Kind(int, Enum):
    """Kind of an interface; the numbers are those of the mesh file."""

    LAMELLA = 0
    CEMENTITE = 1
    COLONY = 2
    BLOCK = 3
    PRIOR_AUSTENITE_GRAIN = 4
    NOTCH = 5


@dataclass(frozen=True, slots=True)
class Microstructure:
    """Mean equivalent circle diameters [um] before shear, and the random seed."""

    prior_austenite_grain: float
    block: float
    colony: float
    seed: int


@dataclass(frozen=True, slots=True)
class Window:
    """Rectangle [0, width] x [0, height] [um]; the notch enters from the left at half height."""

    width: float
    height: float
    notch: float


@dataclass(frozen=True, slots=True)
class Elements:
    """Size and grading of the elements [um].

    ``refinement`` "follow": fine within ``radius`` of the crack, refined ahead of its tip;
    "corridor": fine where |y - height/2| <= corridor; "uniform": fine everywhere. ``kinds``
    "labels": an interface is a boundary where the labels of its elements differ; "cut": where a
    boundary runs along it, else what the lamellae make of it that lie there. ``wake`` "fine": all
    elements round a crack keep their size ("follow"); "coarse": those far behind its tip coarsen.
    """

    width: float
    length: float
    corridor: float
    coarsening: float
    coarsest: float
    shear: Shear
    refinement: Literal["follow", "corridor", "uniform"]
    radius: float
    kinds: Kinds
    wake: Literal["fine", "coarse"]


@dataclass(frozen=True, slots=True)
class Material:
    """Elastic constants [MPa, -] and spring law; plane stress, unit thickness.

    The fracture toughness [MPa sqrt(um)] limits what is called fatigue; no rate depends on it.
    """

    youngs_modulus: float
    poisson_ratio: float
    springs: SpringLaw
    fracture_toughness: float = 40e3


@dataclass(frozen=True, slots=True)
class State:
    """One sheared state: shear strain gamma, plane, yield stress [MPa], threshold [MPa sqrt(um)]."""

    name: str
    shear_strain: float
    orientation: Orientation
    yield_stress: float
    delta_k_th: float


@dataclass(frozen=True, slots=True)
class Damage:
    """Constants of Eq. (28)-(32): c [um/MPa^2], reference_length [um], cementite_strength [MPa]."""

    law: DamageLaw
    c: float
    reference_length: float
    beta: float
    cementite_strength: float
    stress: DrivingStress
    threshold: Threshold
    failure_damage: float


@dataclass(frozen=True, slots=True)
class Loading:
    """Load on the window; delta_k [MPa sqrt(um)], extension [um]."""

    kind: LoadKind
    control: LoadControl
    delta_k: tuple[float, ...]
    load_ratio: float
    extension: float


@dataclass(frozen=True, slots=True)
class CycleJump:
    """Cycle jump: method, largest damage increment in a block, tolerance of "adaptive"."""

    method: CycleJumpLaw
    delta_d: float
    tolerance: float


@dataclass(frozen=True, slots=True)
class Solver:
    """Linear solver: CG with GAMG ("iterative") or old factors ("factors"), "auto" by the size of
    the matrix, or "direct"; relative tolerance; limit of solves per task.
    """

    method: Literal["auto", "iterative", "factors", "direct"]
    relative_tolerance: float
    max_solves: int


@dataclass(frozen=True, slots=True)
class Ensemble:
    """Meshes (repetitions) per state and ranks per task."""

    meshes: int
    ranks_per_task: int


@dataclass(frozen=True, slots=True)
class Output:
    """What is written beside the tables.

    fields: tasks whose fields go to XDMF ("first": mesh 0 at the middle delta_k of each state,
    "all", "none"); field_steps: steps of each series; experiment: CSV of measured points or None.
    """

    fields: Literal["first", "all", "none"]
    field_steps: int
    figures: bool
    experiment: str | None


@dataclass(frozen=True, slots=True)
class Scene:
    """Everything that fixes a run; ``name`` is the file's stem."""

    name: str
    microstructure: Microstructure
    window: Window
    elements: Elements
    material: Material
    states: tuple[State, ...]
    damage: Damage
    loading: Loading
    cycle_jump: CycleJump
    solver: Solver
    ensemble: Ensemble
    output: Output
