"""The growth of one crack as a generator of steps, each a block that its solves bear out."""

import math
from collections import Counter
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from time import perf_counter
from typing import Any, TypeVar

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.errors import SolverError
from pearlite_petsc.fatigue.crack import CrackTracker
from pearlite_petsc.fatigue.cycle_jumps.situation import Block, Trial, Trials
from pearlite_petsc.fatigue.growth_rate import slope
from pearlite_petsc.fatigue.loose import LooseClusters
from pearlite_petsc.fatigue.outcome import GrowthState, Outcome, Step, StopReason
from pearlite_petsc.growth.blocks import Blocks
from pearlite_petsc.growth.checkpoint import Checkpoint, policy_as_array, policy_from_array
from pearlite_petsc.growth.coupling import Coupling
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.growth.first_domain import first_domain
from pearlite_petsc.growth.first_rank import on_first
from pearlite_petsc.growth.front import (
    ACTIVE_DAMAGE,
    Follower,
    carry_damage_over,
    interface_pairs,
    notch_tip,
)
from pearlite_petsc.growth.prepared import Prepared
from pearlite_petsc.growth.softening_tip import softening_tip
from pearlite_petsc.laws.law import called
from pearlite_petsc.scene import Kind, Scene, State
from pearlite_petsc.solver.equilibrium import EquilibriumState
from pearlite_petsc.tessellation.build import tessellate
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.zone import FineZone

T = TypeVar("T")


class CrackGrowth:
    """Grows one crack. Collective over the group; close it when done.

    Args:
        comm: The group.
        scene: The scene.
        state: State of the steel.
        delta_k: Delta-K [MPa sqrt(um)].
        prepared: Microstructure and first mesh on rank 0, None elsewhere.
        checkpoint: What ``checkpoint`` returned, on rank 0; None starts from the notch. Continued
            on as many ranks, the crack is the uninterrupted one bit for bit.
        first: Domain of the first mesh as it is at the start, which stays the caller's to close;
            None makes one.
    """

    def __init__(
        self,
        comm: MPI.Comm,
        scene: Scene,
        state: State,
        delta_k: float,
        prepared: Prepared | None,
        checkpoint: Checkpoint | None = None,
        first: Domain | None = None,
    ) -> None:
        self._started = perf_counter()
        self.comm, self.scene, self.state, self.delta_k = comm, scene, state, delta_k
        self._prepared = prepared
        self._borrowed = first
        self._follower = Follower(scene, comm.bcast(None if prepared is None else prepared.zone))
        self._counters: Counter[str] = Counter()
        self._wall_before = 0.0
        self.solves = self.refinements = 0
        if comm.bcast(checkpoint is not None):
            self._restore(checkpoint)
            return
        self._enter(first or first_domain(comm, scene, prepared), 0.0)
        self._start_length = self._tracker.tip[0]
        self._history = [(0.0, self._start_length, 0.0, 0)]

    def close(self) -> None:
        """Destroy the PETSc objects. Collective."""
        if self.domain is not self._borrowed:
            self.domain.close()

    def steps(self) -> Iterator[Step]:
        """Yield a step after every block, the last one with its reason. Collective.

        Raises:
            SolverError: No equilibrium was found; the message names cycle and crack length.
        """
        stop = None
        while stop is None:
            with self._errors_say_where():
                if self._follower.is_near_coarse(self.comm, self._front()):
                    self._replace_mesh()
                if not self._blocks.is_solved:
                    self._blocks.see(self._solve(self.domain.damage))
                block = self._next_block()
                stop = StopReason.ARRESTED if block is None else self._end(block)
            yield Step(self.cycles, self._tracker.tip[0], self.solves, stop)

    def grown(self) -> Outcome | None:
        """Grow to the end, close, and return what ``outcome`` does. Collective."""
        try:
            *_, last = self.steps()
            assert last.stop is not None
            return self.outcome(last.stop)
        finally:
            self.close()

    @property
    def cycles(self) -> float:
        """N so far [cycles]."""
        return self._blocks.cycles

    def growth_state(self) -> GrowthState | None:
        """Return the state of the last solve on rank 0, None elsewhere. Collective."""
        domain = self.domain
        drive = self._blocks.drive()
        local = (drive.damage, domain.failure_cycles, drive.normal, drive.shear)
        damage, failure_cycles, normal, shear = (domain.gather(values) for values in local)
        motion = domain.gather_unknowns(self._unknowns)
        if domain.mesh is None or self._loose is None:
            return None
        assert damage is not None and failure_cycles is not None and motion is not None
        assert normal is not None and shear is not None
        return GrowthState(
            domain.mesh,
            self.cycles,
            self._tracker.crack(),
            motion,
            damage,
            normal,
            shear,
            failure_cycles,
            self._loose.loose.copy(),
            self.solves,
        )

    def outcome(self, stop: StopReason) -> Outcome | None:
        """Return the result of the task on rank 0, None elsewhere. Collective."""
        damage = self.domain.gather(self.domain.damage)
        mesh = self.domain.mesh
        if mesh is None or damage is None or self._loose is None:
            return None
        crack = self._tracker.crack()
        extension = crack.length - self._start_length
        history = np.array(self._history)
        if history[-1, 0] < self.cycles:
            history = np.vstack([history, [self.cycles, *history[-1, 1:]]])
        grown = np.concatenate([[True], np.diff(history[:, 1]) > 0.0])
        long_enough = extension >= self.scene.microstructure.colony
        broken = (damage >= 1.0) & (mesh.kind != Kind.NOTCH)
        # A crack that stands still has no rate: the slope until then says nothing of its life.
        rate = math.nan if stop is StopReason.ARRESTED else slope(*history[grown, :2].T)
        counters = self._all_counters()
        counters["loose_elements"] = int(self._loose.loose.sum())
        return Outcome(
            state=self.state.name,
            mesh_index=mesh.index,
            delta_k=self.delta_k,
            stop_reason=stop,
            cycles=self.cycles,
            extension=extension,
            da_dn=rate,
            tortuosity=crack.path_length / extension if long_enough else None,
            solves=self.solves,
            refinements=self.refinements,
            counters={name: float(count) for name, count in counters.items()},
            wall_s=self._wall_before + perf_counter() - self._started,
            elements=mesh.element_count,
            history=history,
            path=crack.path,
            broken_pairs=interface_pairs(mesh, broken),
        )

    def checkpoint(self) -> Checkpoint | None:
        """Return all that continuing needs, on rank 0, None elsewhere. Collective.

        To be called between steps.
        """
        domain = self.domain
        solver = domain.equilibrium.state()
        by_interface = self._blocks.by_interface() | {
            "damage": domain.damage,
            "failure_cycles": domain.failure_cycles,
            "set_up_damage": solver.set_up_damage,
        }
        factored, coupling = self._coupling.memory()
        if factored is not None:
            by_interface["coupling_damage"] = factored
        arrays: dict[str, NDArray[Any]] = dict(domain.gather_all(by_interface))
        solutions = self.comm.gather(solver.solution)
        if solutions is None:
            return None
        follower = self._follower
        arrays |= {
            "solution": np.concatenate(solutions),
            "reuse": policy_as_array(solver.policy),
            "history": np.array(self._history, dtype=float),
            "zone_boxes": follower.zone.boxes,
            "zone_discs": follower.zone.discs,
            "kept": np.empty(0, np.int64) if follower.kept is None else follower.kept,
            **coupling,
        }
        numbers = self._blocks.numbers() | {
            "solves": self.solves,
            "refinements": self.refinements,
            "start_length": self._start_length,
            "wall_s": self._wall_before + perf_counter() - self._started,
        }
        counters = {name: int(count) for name, count in self._all_counters().items()}
        return Checkpoint(numbers, counters, arrays)

    def _restore(self, checkpoint: Checkpoint | None) -> None:
        numbers, counters, small = self.comm.bcast(
            None if checkpoint is None else checkpoint.without_large()
        )
        self._wall_before, self._start_length = numbers["wall_s"], numbers["start_length"]
        self.solves, self.refinements = int(numbers["solves"]), int(numbers["refinements"])
        self._history = [(n, a, p, int(b)) for n, a, p, b in small["history"].tolist()]
        self._follower.zone = FineZone(small["zone_boxes"], small["zone_discs"])
        arrays = {} if checkpoint is None else checkpoint.arrays
        prepared = self._prepared
        mesh, ratio = (None, None) if prepared is None else (prepared.mesh, prepared.ratio)
        if self.refinements:
            mesh = on_first(self.comm, lambda: self._refined_mesh(arrays["kept"]))
        damage, failure_cycles = arrays.get("damage"), arrays.get("failure_cycles")
        domain = Domain(self.comm, self.scene, mesh, ratio, damage, failure_cycles)
        self._enter(domain, numbers["cycles"])
        shared = ("memory_", "jump", "coupling_damage")
        names = self.comm.bcast([name for name in arrays if name.startswith(shared)])
        shares = {name: domain.scatter(arrays.get(name)) for name in names}
        self._blocks.resume(numbers, shares)
        set_up_damage = domain.scatter(arrays.get("set_up_damage"))
        solution = self.comm.bcast(arrays.get("solution"))[domain.subdomain.owned_elements]
        policy = policy_from_array(small["reuse"])
        domain.equilibrium.restore(EquilibriumState(set_up_damage, solution, policy))
        if "coupling_damage" in shares:
            self._coupling.recall(shares["coupling_damage"], small)
        self._unknowns = domain.equilibrium.system.unknowns()
        domain.equilibrium.counters.clear()
        self._counters = Counter(counters)

    def _enter(self, domain: Domain, cycles: float) -> None:
        """Take up a domain: blocks, crack and clusters on its mesh. Collective."""
        self.domain = domain
        self._loaded_tip: tuple[float, float] | None = None
        damage = domain.gather(domain.damage)
        tip = None if domain.mesh is None else notch_tip(domain.mesh)
        self._tracker = CrackTracker(*self.comm.bcast(tip))
        kind = domain.subdomain.kind
        broken = domain.damage >= 1.0
        for notch in (True, False):
            chosen = np.flatnonzero(broken & ((kind == Kind.NOTCH) == notch))
            _, pairs, junctions, ends = domain.share_edges(chosen)
            self._tracker.add(pairs, junctions, ends, notch=notch)
        # Not a method of this crack: in a cycle, a mesh would stay until garbage is collected.
        self._load_at = partial(domain.load, self.delta_k)
        self._coupling = Coupling(domain, self._tracker, self._load_at)
        self._blocks = Blocks(self.scene, self.state, domain, self._coupling, cycles)
        self._loose = on_first(
            self.comm, lambda: LooseClusters(_there(domain.mesh), _there(damage) >= 1.0)
        )

    def _solve(self, damage: FloatArray) -> FloatArray:
        """Return the jumps of this rank's interfaces at a damage; (k, 3). Collective."""
        tip = softening_tip(self.domain, self._tracker, self._blocks.released(damage))
        if tip != self._loaded_tip:
            self._load = self._load_at(tip)
            self._loaded_tip = tip
        self.domain.equilibrium.update(damage)
        self._unknowns = self.domain.equilibrium.solve(self._load)
        self.solves += 1
        return self.domain.equilibrium.jumps(self._unknowns)

    def _next_block(self) -> Block | None:
        """Run the cycle jump and answer its trials; None where no interface has a rate."""
        settings = self.scene.cycle_jump
        found: Block | Trials | None = called(settings.method, self._blocks.situation(), settings)
        if not isinstance(found, Generator):
            return found
        try:
            trial = next(found)
            while not self._reaches_edge(trial):
                trial = found.send(self._solve(trial.damage))
        except StopIteration as end:
            block: Block | None = end.value
            return block
        # No equilibrium need exist there, and the crack has ended anyway.
        return Block(trial.cycles, trial.damage)

    def _reaches_edge(self, trial: Trial) -> bool:
        """Return whether a trial brings the crack to the window's edge. Collective.

        Raises:
            SolverError: It cuts off a cluster that carries boundary load.
        """
        broken = self._blocks.broken_by(trial.damage)
        numbers, pairs, junctions, ends = self.domain.share_edges(broken)
        interfaces = zip(pairs.tolist(), junctions.tolist(), ends.tolist(), strict=True)
        reached = self._tracker.reached_after(list(interfaces))
        if self._follower.touches_boundary(reached):
            return True
        try:
            on_first(self.comm, lambda: _there(self._loose).attempt(numbers))
        except SolverError:
            # The message that names the cycle is that of the break.
            self._blocks.cycles += trial.cycles
            raise
        return False

    def _end(self, block: Block) -> StopReason | None:
        """Take what a block broke into the crack and say whether it has ended. Collective."""
        self._blocks.end(block)
        numbers, pairs, junctions, ends = self.domain.share_edges(self._blocks.fresh)
        reached = self._tracker.add(pairs, junctions, ends)
        if len(numbers):
            self._blocks.see_breaks(ends)
            crack_length = self._tracker.tip[0]
            row = (self.cycles, crack_length, self._tracker.path_length, self._tracker.broken)
            self._history.append(row)
        stop = self._reason_to_stop(reached)
        # At the window's edge a crack may have cut it in two: its end, not an error.
        if self._loose is not None and not self._follower.touches_boundary(reached):
            self._loose.take(numbers)
        return stop

    @contextmanager
    def _errors_say_where(self) -> Iterator[None]:
        try:
            yield
        except SolverError as error:
            where = f"at N = {self.cycles:.6g} cycles, a = {self._tracker.tip[0]:.2f} um"
            raise SolverError(f"{where}: {error}") from error

    def _reason_to_stop(self, reached: Sequence[tuple[float, float]]) -> StopReason | None:
        extension = self._tracker.tip[0] - self._start_length
        if extension >= self.scene.loading.extension:
            return StopReason.GROWN
        if self._follower.touches_boundary(reached):
            return StopReason.BOUNDARY
        if self._follower.has_left(reached):
            return StopReason.LEFT_REFINED_ZONE
        if self.solves >= self.scene.solver.max_solves:
            return StopReason.MAX_SOLVES
        return None

    def _all_counters(self) -> Counter[str]:
        return self._counters + self._blocks.counters + self.domain.equilibrium.counters

    def _front(self) -> FloatArray:
        """Return what must lie well inside the fine zone on this rank [um]; (p, 2)."""
        domain = self.domain
        chosen = (domain.damage > ACTIVE_DAMAGE) & (domain.damage < 1.0)
        return np.vstack([domain.subdomain.midpoint[chosen], self._tracker.tip])

    def _replace_mesh(self) -> None:
        """Go on with a mesh whose fine zone covers the front again. Collective."""
        old, blocks = self.domain, self._blocks
        # Sorted, so that the fine zone does not depend on which rank found which point.
        front = np.unique(np.concatenate(self.comm.allgather(self._front())), axis=0)
        gathered = old.gather_all({"damage": old.damage, "failure_cycles": old.failure_cycles})
        self._follower.move(front)
        mesh = on_first(self.comm, lambda: self._next_mesh(gathered["damage"]))
        ratio = None if self._prepared is None else self._prepared.ratio
        carried = {}
        if old.mesh is not None and mesh is not None:
            carried = carry_damage_over(old.mesh, mesh, gathered)
        self._counters = self._all_counters()
        self.close()
        damage, failure_cycles = carried.get("damage"), carried.get("failure_cycles")
        domain = Domain(self.comm, self.scene, mesh, ratio, damage, failure_cycles)
        self._enter(domain, blocks.cycles)
        self._blocks.resume(blocks.numbers(), {})
        self.refinements += 1

    def _refined_mesh(self, kept: IntArray) -> Mesh:
        """Return the mesh of the restored zone; first rank only."""
        self._follower.kept = kept
        return tessellate(_there(self._prepared).substrate, self._follower.zone, kept)

    def _next_mesh(self, damage: FloatArray) -> Mesh:
        """Return the mesh of the moved zone; first rank only."""
        substrate = _there(self._prepared).substrate
        return self._follower.mesh(substrate, _there(self.domain.mesh), damage)


def _there(value: T | None) -> T:
    assert value is not None
    return value
