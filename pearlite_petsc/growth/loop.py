"""The growth of one crack as a generator of steps, each a block that its solves bear out."""

from collections.abc import Generator, Iterator
from contextlib import ExitStack, contextmanager
from time import perf_counter
from typing import TypeVar

from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.errors import SolverError
from pearlite_petsc.fatigue.cycle_jumps.situation import Block, Trial, Trials
from pearlite_petsc.fatigue.outcome import GrowthState, Outcome, Step, StopReason
from pearlite_petsc.growth.block_check import refuse_impossible
from pearlite_petsc.growth.body import CrackedBody
from pearlite_petsc.growth.case import CrackCase
from pearlite_petsc.growth.checkpoint import Checkpoint
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.growth.prepared import Prepared
from pearlite_petsc.growth.record import outcome_of
from pearlite_petsc.growth.remeshing import needs_another_mesh, next_mesh
from pearlite_petsc.growth.start import from_checkpoint, from_notch
from pearlite_petsc.growth.stopping import reason_to_stop, touches_edge
from pearlite_petsc.growth.tip import with_tip
from pearlite_petsc.laws.law import called
from pearlite_petsc.scene import Scene, State
from pearlite_petsc.solver.closing import Closing

T = TypeVar("T")


class CrackGrowth(Closing):
    """Grows one crack. Collective over the group; close it.

    Args:
        comm: The group.
        scene: The scene.
        state: State of the steel.
        delta_k: Delta-K [MPa sqrt(um)].
        prepared: Microstructure and first mesh on rank 0, None elsewhere.
        checkpoint: What ``checkpoint`` returned, on rank 0; None starts from the notch. Continued
            on as many ranks, the crack is the uninterrupted one bit for bit.
        shared: Domain of the first mesh as it is at the start, which stays the caller's to close;
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
        shared: Domain | None = None,
    ) -> None:
        self._started = perf_counter()
        self.comm, self.case = comm, CrackCase(scene, state, delta_k)
        self._prepared = prepared
        saved = comm.bcast(None if checkpoint is None else checkpoint.without_arrays())
        self._owns_domain = saved is not None or shared is None
        if saved is not None:
            start = from_checkpoint(comm, self.case, prepared, checkpoint or saved)
        else:
            start = from_notch(comm, self.case, prepared, shared)
        self._body, self._damage = start.body, start.damage
        self._refinement, self._record = start.refinement, start.record

    def close(self) -> None:
        """Destroy the PETSc objects. Collective."""
        if self._owns_domain:
            self.domain.close()

    def steps(self) -> Iterator[Step]:
        """Yield a step at N = 0 and one after every block, the last with its reason. Collective.

        Raises:
            SolverError: No equilibrium was found; the message names cycle and crack length.
        """
        stop = None
        at_start = self._record.solves == 0
        while stop is None:
            with _errors_that_say_where(self):
                elements = self.case.scene.elements
                if needs_another_mesh(elements, self._body, self._damage, self._refinement):
                    self._replace_mesh()
                if not self._damage.is_solved:
                    self._damage = self._damage.solved(self._solve(self._damage.damage))
                self._record = with_tip(self._record, self.case, self._body, self._damage)
            if at_start:
                at_start = False
                yield Step(self.cycles, self._body.tracker.tip[0], self._record.solves, None)
            with _errors_that_say_where(self):
                block = self._next_block()
                stop = StopReason.ARRESTED if block is None else self._end(block)
                if stop is not None:
                    self._record = with_tip(self._record, self.case, self._body, self._damage)
            yield Step(self.cycles, self._body.tracker.tip[0], self._record.solves, stop)

    def grown(self) -> Outcome | None:
        """Grow to the end, close, and return what ``outcome`` does. Collective."""
        with self:
            *_, last = self.steps()
            assert last.stop is not None
            return self.outcome(last.stop)

    @property
    def cycles(self) -> float:
        """N so far [cycles]."""
        return self._damage.cycles

    @property
    def domain(self) -> Domain:
        """The mesh of now."""
        return self._body.domain

    def growth_state(self) -> GrowthState | None:
        """Return the state of the last solve on rank 0, None elsewhere. Collective."""
        domain = self.domain
        drive = self._body.situation(self._damage).drive
        local = (drive.damage, self._damage.failure_cycles, drive.normal, drive.shear)
        damage, failure_cycles, normal, shear = (domain.gather(values) for values in local)
        motions = domain.motions()
        if domain.mesh is None:
            return None
        return GrowthState(
            domain.mesh,
            self.cycles,
            self._body.tracker.crack(),
            _there(motions),
            _there(damage),
            _there(normal),
            _there(shear),
            _there(failure_cycles),
            _there(self._body.loose()),
            self._record.solves,
        )

    def outcome(self, stop: StopReason) -> Outcome | None:
        """Return the result of the task on rank 0, None elsewhere. Collective."""
        domain, body = self.domain, self._body
        damage = domain.gather(self._damage.damage)
        if domain.mesh is None:
            return None
        loose, crack = _there(body.loose()), body.tracker.crack()
        record = self._record.now(domain.equilibrium.counters, perf_counter() - self._started)
        return outcome_of(
            self.case,
            stop,
            record,
            domain.mesh,
            crack,
            self.cycles,
            _there(damage),
            loose,
            body.wake,
        )

    def checkpoint(self) -> Checkpoint | None:
        """Return all that continuing needs, on rank 0, None elsewhere. Collective.

        To be called between steps.
        """
        equilibrium, coupling = self.domain.equilibrium.state(), self._body.coupling.state()
        record = self._record.now(self.domain.equilibrium.counters, perf_counter() - self._started)
        local = Checkpoint(self._refinement, self._damage, equilibrium, coupling, record)
        return local.gathered(self.domain)

    def _solve(self, damage: FloatArray) -> FloatArray:
        """Return the jumps of this rank's interfaces at a damage; (k, 3). Collective."""
        self._record = self._record.solved()
        return self._body.solve(damage)

    def _next_block(self) -> Block | None:
        """Run the cycle jump and answer its trials; None where no interface has a rate."""
        settings = self.case.scene.cycle_jump
        found: Block | Trials | None = called(
            settings.method, self._body.situation(self._damage), settings
        )
        block = self._answered(found) if isinstance(found, Generator) else found
        if block is not None:
            refuse_impossible(self.comm, block, self._damage.damage)
        return block

    def _answered(self, trials: Trials) -> Block | None:
        """Return the block at the end of trials, each answered by a solve."""
        jump = None
        try:
            trial = next(trials)
            while not self._reaches_edge(trial):
                jump = self._solve(trial.damage)
                trial = trials.send(jump)
        except StopIteration as end:
            block: Block | None = end.value
            return block
        # No equilibrium need exist there, and the crack has ended anyway: the last solve's jumps stay.
        return Block(trial.cycles, trial.damage, jump)

    def _reaches_edge(self, trial: Trial) -> bool:
        """Return whether a trial brings the crack to the window's edge. Collective.

        Raises:
            SolverError: It cuts off a cluster that carries boundary load.
        """
        refuse_impossible(self.comm, trial, self._damage.damage)
        broken = self.domain.edges(self._damage.broken_by(trial.damage))
        if touches_edge(self.case.scene, self._body.reached_by(broken)):
            return True
        try:
            self._body.check_attached(broken)
        except SolverError:
            # The message that names the cycle is that of the break.
            self._damage = self._damage.after(Block(trial.cycles, trial.damage))
            raise
        return False

    def _end(self, block: Block) -> StopReason | None:
        """Take what a block broke into the crack and say whether it has ended. Collective."""
        body, scene = self._body, self.case.scene
        broken = self.domain.edges(self._damage.broken_by(block.damage))
        self._damage = self._damage.after(block)
        self._record = self._record.counting(block.counts)
        reached = body.lengthen(broken)
        tracker = body.tracker
        if len(broken.numbers):
            self._damage = self._damage.forgotten(body.near(broken))
            self._record = self._record.with_break(
                self.cycles, tracker.tip[0], tracker.path_length, tracker.broken
            )
        # At the window's edge a crack may have cut it in two: its end, not an error.
        if not touches_edge(scene, reached):
            body.loosen(broken)
        extension = tracker.tip[0] - self._record.start_length
        return reason_to_stop(scene, extension, reached, self._record.solves)

    def _replace_mesh(self) -> None:
        """Go on with a mesh whose fine zone covers the front again. Collective."""
        scene, prepared = self.case.scene, self._prepared
        self._refinement, mesh, carried = next_mesh(
            scene.elements, self._body, self._damage, prepared
        )
        self._record = self._record.refined(self.domain.equilibrium.counters)
        self.close()
        self._owns_domain = False
        ratio = None if prepared is None else prepared.ratio
        with ExitStack() as stack:
            new = stack.enter_context(Domain(self.comm, scene, mesh, ratio, carried.damage))
            self._damage = carried.on_interfaces(new.scatter)
            wake = self._refinement.wake
            self._body = CrackedBody(new, self.case, self._damage.damage, wake)
            stack.pop_all()
        self._owns_domain = True


@contextmanager
def _errors_that_say_where(growth: CrackGrowth) -> Iterator[None]:
    try:
        yield
    except SolverError as error:
        length = growth._body.tracker.tip[0]
        where = f"at N = {growth.cycles:.6g} cycles, a = {length:.2f} um"
        raise SolverError(f"{where}: {error}") from error


def _there(value: T | None) -> T:
    assert value is not None
    return value
