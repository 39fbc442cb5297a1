"""Relations between two runs that hold whatever the right answer is."""

from dataclasses import dataclass, replace

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.fatigue.damage import damage_interfaces
from pearlite_petsc.fatigue.drive import Drive
from pearlite_petsc.fatigue.extrapolation import Extrapolation
from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.growth.prepared import Prepared, prepare_growth
from pearlite_petsc.mechanics.loads import AiryFunction, williams_mode_one
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.mechanics.statics import solve
from pearlite_petsc.microstructure.labels import LabelMap, Level
from pearlite_petsc.scene import Kind, Scene, State
from pearlite_petsc.studies.bodies import rotated
from pearlite_petsc.studies.cases import DAMAGE, STATES, STEEL, scene_of
from pearlite_petsc.studies.growing import grow_alone
from pearlite_petsc.studies.verification.claim import Section, Setting
from pearlite_petsc.studies.verification.exact import turned_load
from pearlite_petsc.tessellation.build import tessellate
from pearlite_petsc.tessellation.mesh import Mesh

WINDOW = (90.0, 90.0, 36.0)
DELTA_K = 2e4
_BLOCKS = 25


def metamorphic(setting: Setting) -> Section:
    """Return the claims about pairs of runs."""
    section = Section("Metamorphic relations")
    names = list(STATES)[: setting.pick(1, 3, 5)]
    scene = scene_of(WINDOW, (3.0, 4.0), extension=18.0)
    for name in names:
        state = STATES[name]
        prepared = prepare_growth(scene, state, 0)
        first = grow_alone(scene, state, DELTA_K, prepared)
        _threshold_free(section, scene, state, prepared)
        _constant(section, scene, state, prepared, first)
        _mirror(section, scene, state, prepared, first)
        _kinds(section, scene, state, prepared)
        _turned(section, prepared.mesh, state)
    _control(section, setting)
    return section


def _threshold_free(section: Section, scene: Scene, state: State, prepared: Prepared) -> None:
    free = replace(state, delta_k_th=0.0)
    single, double = (grow_alone(scene, free, factor * DELTA_K, prepared) for factor in (1.0, 2.0))
    _same_cracks(section, f"{state.name}: Delta-K_th = 0 and Delta-K doubled", single, double)
    section.close(
        f"{state.name}: Delta-K_th = 0 and Delta-K doubled: ratio of da/dN",
        "third power of Eq. (28)-(31)",
        8.0,
        double.da_dn / single.da_dn,
        1e-6,
    )


def _constant(
    section: Section, scene: Scene, state: State, prepared: Prepared, first: Outcome
) -> None:
    doubled = replace(scene, damage=replace(scene.damage, c=2.0 * scene.damage.c))
    second = grow_alone(doubled, state, DELTA_K, prepared)
    _same_cracks(section, f"{state.name}: C doubled", first, second)
    section.close(
        f"{state.name}: C doubled: ratio of cycles",
        "Eq. (28)-(31), linear in C",
        0.5,
        second.cycles / first.cycles,
        1e-12,
    )


def mirrored(prepared: Prepared) -> Prepared:
    """Return the microstructure mirrored at the notch's line (refinement "uniform")."""
    substrate = prepared.substrate
    points = substrate.points.copy()
    points[:, 1] = substrate.window.height - points[:, 1]
    other = replace(
        substrate,
        points=points,
        lamella_angle=_mirrored_angle(substrate.lamella_angle),
        label_map=_mirrored_map(substrate.label_map),
    )
    return Prepared(other, prepared.zone, tessellate(other, prepared.zone), prepared.ratio)


def _mirrored_map(label_map: LabelMap) -> LabelMap:
    flip = np.diag([1.0, -1.0])
    deformation = flip @ label_map.deformation @ flip
    # Mirrored about half height: a place p goes to flip p + (0, height), a seed likewise.
    shift = np.linalg.inv(deformation) @ [0.0, label_map.window[1]]
    grains, blocks, colonies = (
        Level.of(level.seeds @ flip + shift, level.parent) for level in label_map.levels
    )
    return replace(
        label_map,
        levels=(grains, blocks, colonies),
        lamella_angle=_mirrored_angle(label_map.lamella_angle),
        undeformed_angle=_mirrored_angle(label_map.undeformed_angle),
        deformation=deformation,
    )


def _mirrored_angle(angle: FloatArray) -> FloatArray:
    return np.mod(np.pi - angle, np.pi)


def _mirror(
    section: Section, scene: Scene, state: State, prepared: Prepared, first: Outcome
) -> None:
    second = grow_alone(scene, state, DELTA_K, mirrored(prepared))
    _same_cracks(section, f"{state.name}: microstructure mirrored", first, second)
    assert first.shape is not None and second.shape is not None
    back = second.shape.path * [1.0, -1.0] + [0.0, scene.window.height]
    same = back.shape == first.shape.path.shape
    section.below(
        f"{state.name}: the mirrored crack is the crack mirrored: largest distance of its points, um",
        "symmetry of load and law",
        float(np.abs(back - first.shape.path).max()) if same else float("inf"),
        1e-9,
    )
    section.close(
        f"{state.name}: microstructure mirrored: ratio of da/dN",
        "symmetry of load and law",
        1.0,
        second.da_dn / first.da_dn,
        1e-9,
    )


def _kinds(section: Section, scene: Scene, state: State, prepared: Prepared) -> None:
    equal = replace(scene, damage=replace(scene.damage, cementite_strength=state.yield_stress))
    mesh = prepared.mesh
    single = np.where(mesh.kind == Kind.NOTCH, mesh.kind, int(Kind.LAMELLA))
    one_kind = replace(
        prepared, mesh=replace(mesh, kind=single, cementite_share=np.zeros(len(single)))
    )
    first, second = (grow_alone(equal, state, DELTA_K, each) for each in (prepared, one_kind))
    _same_cracks(
        section, f"{state.name}: sigma_c = sigma_yield, all interfaces one kind", first, second
    )
    section.close(
        f"{state.name}: sigma_c = sigma_yield, all interfaces one kind: ratio of cycles",
        "kinds act through their strength alone",
        1.0,
        second.cycles / first.cycles,
        0.0,
    )


def _same_cracks(section: Section, statement: str, first: Outcome, second: Outcome) -> None:
    assert first.shape is not None and second.shape is not None
    same = np.array_equal(first.shape.broken_pairs, second.shape.broken_pairs)
    section.true(
        f"{statement}: same broken interfaces",
        "the load only scales",
        f"{len(first.shape.broken_pairs)} broken",
        "the same" if same else f"{len(second.shape.broken_pairs)}, not the same",
        same and len(first.shape.broken_pairs) > 3,
    )


@dataclass(frozen=True, slots=True, eq=False)
class FixedLoadRun:
    """Damage under a load that stays where it is: order of breaks, their cycles."""

    broken: IntArray
    cycles: FloatArray


def grow_under_fixed_load(mesh: Mesh, state: State, airy: AiryFunction) -> FixedLoadRun:
    """Let interfaces break block by block under a load that does not follow the crack.

    Needs no notion of where the crack's tip is, and so no frame.
    """
    stiffness = spring_stiffness(mesh, STEEL)
    interfaces = damage_interfaces(mesh.length, mesh.kind, DAMAGE, state, 0.0)
    constants = DAMAGE.law.rate_constants(interfaces, DAMAGE)
    value = (mesh.kind == Kind.NOTCH).astype(float)
    # Softened springs are put in as such; broken ones are taken out.
    cycles, order, when = 0.0, [], []
    for _ in range(_BLOCKS):
        intact = 1.0 - value
        soft = replace(stiffness, k_n=stiffness.k_n * intact, k_t=stiffness.k_t * intact)
        traction = solve(mesh, soft, value >= 1.0, airy).traction
        effective = traction / np.where(intact > 0.0, intact, 1.0)[:, None]
        drive = Drive(value, effective[:, 0], effective[:, 1], constants, 1.0, False)
        block = Extrapolation(drive, 1.0, "euler")
        cycles += block.longest
        after = block.damage_after(block.longest)
        fresh = np.flatnonzero((after >= 1.0) & (value < 1.0))
        order += fresh.tolist()
        when += [cycles] * len(fresh)
        value = after
    return FixedLoadRun(np.array(order), np.array(when))


def _turned(section: Section, mesh: Mesh, state: State) -> None:
    free = replace(state, delta_k_th=0.0)
    airy = williams_mode_one(DELTA_K, mesh.notch)
    angle = 0.5 * np.pi
    here = grow_under_fixed_load(mesh, free, airy)
    there = grow_under_fixed_load(rotated(mesh, angle), free, turned_load(airy, angle))
    same = np.array_equal(here.broken, there.broken)
    section.true(
        f"{state.name}: window and load turned by 90 degrees: same interfaces break in one order",
        "objectivity of Eq. (1)-(32)",
        f"{len(here.broken)} broken",
        "the same" if same else "others",
        same and len(here.broken) > 3,
    )
    section.below(
        f"{state.name}: window and load turned by 90 degrees: largest change of a failure's cycles",
        "objectivity of Eq. (1)-(32)",
        float(np.abs(there.cycles / here.cycles - 1.0).max()) if same else float("inf"),
        1e-9,
    )


def _control(section: Section, setting: Setting) -> None:
    """Add the control run: one strength, one threshold, no cementite; only geometry is left."""
    meshes = setting.pick(1, 4, 10)
    base = scene_of((120.0, 120.0, 48.0), (3.0, 4.0), "follow", extension=30.0)
    strength = STATES["undeformed"].yield_stress
    scene = replace(base, damage=replace(base.damage, cementite_strength=strength))
    rows = []
    rates: dict[str, FloatArray] = {}
    for name, state in STATES.items():
        same = replace(state, yield_stress=strength, delta_k_th=0.0)
        found = [
            grow_alone(scene, same, DELTA_K, prepare_growth(scene, state, index)).da_dn
            for index in range(meshes)
        ]
        rates[name] = np.log(np.array(found))
    reference = rates["undeformed"].mean()
    for name, logs in rates.items():
        ratio = float(np.exp(logs.mean() - reference))
        spread = f"{np.exp(logs.std(ddof=1)):.2f}" if len(logs) > 1 else "-"
        rows.append([name, f"{np.exp(logs.mean()):.3g}", spread, f"{ratio:.2f}"])
    section.text.append(
        "Control run: sigma_c = sigma_yield = 470 MPa and no threshold in all states, so that they "
        f"differ through the directions of their elements alone; {meshes} meshes a state, "
        "Delta-K 20 MPa sqrt(m). Geometric mean of da/dN, its factor of scatter from mesh to mesh, "
        "and the ratio to undeformed, which a method without mesh bias would leave at 1."
    )
    section.table(["state", "da/dN um/cycle", "scatter", "over undeformed"], rows)
