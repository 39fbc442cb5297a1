"""What is measured and counted of a crack while it grows, and the outcome made of it."""

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray
from pearlite_petsc.fatigue.growth_rate import advances, slope
from pearlite_petsc.fatigue.outcome import Crack, CrackShape, Effort, Outcome, StopReason
from pearlite_petsc.growth.case import CrackCase
from pearlite_petsc.growth.refinement import interface_pairs
from pearlite_petsc.mechanics.tip_fields import TipFields
from pearlite_petsc.scene import Kind
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.wake import Wake

_UNKNOWN_TIP = (math.nan, math.nan, math.nan)


@dataclass(frozen=True, slots=True, eq=False)
class Record:
    """Lengths, counts and wall time so far.

    Attributes:
        history: Columns cycles, crack_length, path_length, broken_interfaces [cycles, um, um, -],
            then K_I and K_II at the tip over Delta-K and the misfit of their measurement, NaN where
            there is none; one row a change of the crack, the first at its start; (h, 7).
        solves, refinements: Linear solves, meshes replaced.
        counters: Counts of the blocks, and of the solvers of meshes that were replaced.
        wall_s: Wall time [s].
    """

    history: FloatArray
    solves: int
    refinements: int
    counters: Mapping[str, int]
    wall_s: float

    @property
    def start_length(self) -> float:
        """Crack length at the start [um]."""
        return float(self.history[0, 1])

    def solved(self) -> "Record":
        """Return the record after one more solve."""
        return replace(self, solves=self.solves + 1)

    def refined(self, counts: Mapping[str, int]) -> "Record":
        """Return the record after one more mesh, with the counts of the last one's solver."""
        return replace(self.counting(counts), refinements=self.refinements + 1)

    def counting(self, counts: Mapping[str, int]) -> "Record":
        """Return the record with more counts."""
        return replace(self, counters=Counter(self.counters) + Counter(counts))

    def with_break(self, cycles: float, length: float, path: float, broken: int) -> "Record":
        """Return the record with a row of the history [cycles, um, um, -]."""
        row = np.array([[cycles, length, path, broken, *_UNKNOWN_TIP]])
        return replace(self, history=np.concatenate([self.history, row]))

    @property
    def lacks_tip(self) -> bool:
        """Whether K has not been measured since the crack last changed."""
        return bool(np.isnan(self.history[-1, -1]))

    def with_tip(self, fields: TipFields, delta_k: float) -> "Record":
        """Return the record with what was measured at the tip of now under Delta-K [MPa sqrt(um)]."""
        history = self.history.copy()
        history[-1, -len(_UNKNOWN_TIP) :] = (
            fields.k_1 / delta_k,
            fields.k_2 / delta_k,
            fields.misfit,
        )
        return replace(self, history=history)

    def now(self, counts: Mapping[str, int], seconds: float) -> "Record":
        """Return the record with the counts of the present mesh's solver, seconds later."""
        return replace(self.counting(counts), wall_s=self.wall_s + seconds)


def new_record(crack_length: float) -> Record:
    """Return the record of a crack that starts at a length [um]."""
    return Record(np.array([[0.0, crack_length, 0.0, 0.0, *_UNKNOWN_TIP]]), 0, 0, {}, 0.0)


def outcome_of(
    case: CrackCase,
    stop: StopReason,
    record: Record,
    mesh: Mesh,
    crack: Crack,
    cycles: float,
    damage: FloatArray,
    loose: BoolArray,
    wake: Wake | None = None,
) -> Outcome:
    """Return the outcome of a crack.

    Args:
        case: The crack.
        stop: Why it ended.
        record: What was measured and counted.
        mesh: The last mesh.
        crack: The crack on it.
        cycles: N at the end.
        damage: D of the mesh's interfaces; (k,).
        loose: Elements that hang on no load-bearing interface; (n,).
        wake: The crack where its elements have coarsened.
    """
    extension = crack.length - record.start_length
    history = record.history
    if history[-1, 0] < cycles:
        history = np.vstack([history, [cycles, *history[-1, 1:]]])
    long_enough = extension >= case.scene.microstructure.colony
    pairs = interface_pairs(mesh, (damage >= 1.0) & (mesh.kind != Kind.NOTCH))
    if wake is not None:
        pairs = np.unique(np.concatenate([pairs, wake.pairs]), axis=0)
    # A crack that stands still has no rate: the slope until then says nothing of its life.
    rate = (
        math.nan if stop is StopReason.ARRESTED else slope(*history[advances(history[:, 1]), :2].T)
    )
    counters = {**record.counters, "loose_elements": int(loose.sum())}
    return Outcome(
        state=case.state.name,
        mesh_index=mesh.index,
        delta_k=case.delta_k,
        stop_reason=stop,
        cycles=cycles,
        extension=extension,
        da_dn=rate,
        tortuosity=crack.path_length / extension if long_enough else None,
        history=history,
        effort=Effort(
            solves=record.solves,
            refinements=record.refinements,
            counters={name: float(count) for name, count in counters.items()},
            wall_s=record.wall_s,
            elements=mesh.element_count,
        ),
        shape=CrackShape(crack.path, pairs),
    )
