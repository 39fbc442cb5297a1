"""Small meshes and cracks made without the program's mesher and solver."""

import numpy as np
from scipy.spatial import Voronoi

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.fatigue.outcome import (
    Crack,
    CrackShape,
    Effort,
    GrowthState,
    Outcome,
    StopReason,
)
from pearlite_petsc.scene import Kind
from pearlite_petsc.tessellation.mesh import Mesh


def voronoi_mesh(columns: int = 8, rows: int = 8, size: float = 10.0, seed: int = 1) -> Mesh:
    """Return the bounded Voronoi diagram of a jittered grid; the notch is the facets at mid height.

    Points are mirrored across the window's edges and across mid height, so that both are straight.
    """
    width, height = columns * size, rows * size
    centre = _jittered_grid(columns, rows, size, seed)
    images = [centre]
    for axis, extent in ((0, width), (1, height)):
        for edge in (0.0, extent):
            image = centre.copy()
            image[:, axis] = 2.0 * edge - image[:, axis]
            images.append(image)
    diagram = Voronoi(np.concatenate(images))
    count = len(centre)
    used = np.unique(np.concatenate([diagram.regions[r] for r in diagram.point_region[:count]]))
    renumber = np.full(len(diagram.vertices), -1)
    renumber[used] = np.arange(len(used))
    vertices = diagram.vertices[used]
    polygons = []
    for element in range(count):
        corners = renumber[diagram.regions[diagram.point_region[element]]]
        arm = vertices[corners] - centre[element]
        polygons.append(corners[np.argsort(np.arctan2(arm[:, 1], arm[:, 0]))])
    pairs, facets = np.sort(diagram.ridge_points, axis=1), np.asarray(diagram.ridge_vertices)
    inner = pairs[:, 1] < count
    outer = (pairs[:, 0] < count) & ~inner & np.all(facets >= 0, axis=1)
    elements, ends = _long(pairs[inner], renumber[facets[inner]], vertices, size)
    boundary, boundary_ends = _long(pairs[outer, 0], renumber[facets[outer]], vertices, size)
    arm = vertices[boundary_ends] - [0.5 * width, 0.5 * height]
    clockwise = arm[:, 0, 0] * arm[:, 1, 1] - arm[:, 0, 1] * arm[:, 1, 0] < 0.0
    boundary_ends[clockwise] = boundary_ends[clockwise][:, ::-1]
    return _mesh(
        vertices,
        centre,
        polygons,
        (elements, ends),
        (boundary, boundary_ends),
        (columns, rows, size, seed),
    )


def _jittered_grid(columns: int, rows: int, size: float, seed: int) -> FloatArray:
    x, y = np.meshgrid(np.arange(columns) + 0.5, np.arange(rows // 2) + 0.5)
    lower = np.stack([x.ravel(), y.ravel()], axis=1) * size
    lower += np.random.default_rng(seed).uniform(-0.25, 0.25, lower.shape) * size
    return np.concatenate([lower, lower * [1.0, -1.0] + [0.0, rows * size]])


def _long(
    owners: IntArray, ends: IntArray, vertices: FloatArray, size: float
) -> tuple[IntArray, IntArray]:
    """Return facets without those of no length."""
    keep = np.linalg.norm(np.diff(vertices[ends], axis=1)[:, 0], axis=1) > 1e-6 * size
    return owners[keep], ends[keep]


def _mesh(
    vertices: FloatArray,
    centre: FloatArray,
    polygons: list[IntArray],
    inner: tuple[IntArray, IntArray],
    boundary: tuple[IntArray, IntArray],
    grid: tuple[int, int, float, int],
) -> Mesh:
    elements, ends = inner
    columns, rows, size, seed = grid
    width, height = columns * size, rows * size
    normal = centre[elements[:, 1]] - centre[elements[:, 0]]
    midpoint = vertices[ends].mean(axis=1)
    colony = (centre[:, 0] // (2.0 * size)).astype(np.int64)
    kind = np.where(colony[elements[:, 0]] != colony[elements[:, 1]], Kind.COLONY, Kind.LAMELLA)
    notch = (np.abs(midpoint[:, 1] - 0.5 * height) < 1e-9) & (midpoint[:, 0] < 0.4 * width)
    tip = vertices[ends[notch]].reshape(-1, 2)[:, 0].max()
    return Mesh(
        vertices=vertices,
        junction=np.arange(len(vertices)),
        centre=centre,
        area=np.array([_area(vertices[corners]) for corners in polygons]),
        offsets=np.concatenate([[0], np.cumsum([len(p) for p in polygons])]),
        vertex_indices=np.concatenate(polygons),
        colony=colony,
        block=colony // 2,
        prior_austenite_grain=colony // 4,
        lamella_angle=np.mod(0.7 * colony, np.pi),
        nucleus=np.arange(len(centre)),
        fine=np.ones(len(centre), dtype=bool),
        interface_elements=elements,
        interface_vertices=ends,
        length=np.linalg.norm(vertices[ends[:, 1]] - vertices[ends[:, 0]], axis=1),
        midpoint=midpoint,
        normal=normal / np.linalg.norm(normal, axis=1)[:, None],
        kind=np.where(notch, Kind.NOTCH, kind).astype(np.int64),
        cementite_share=np.zeros(len(kind)),
        boundary_elements=boundary[0],
        boundary_vertices=boundary[1],
        window=(width, height),
        notch=(float(tip), 0.5 * height),
        state="undeformed",
        index=0,
        seed=seed,
    )


def _area(corners: FloatArray) -> float:
    x, y = corners.T
    return float(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def growth_states(mesh: Mesh, count: int, seed: int = 3) -> list[GrowthState]:
    """Return a crack that opens the mid-height facets one after the other, with random motions."""
    rng = np.random.default_rng(seed)
    mid = np.abs(mesh.midpoint[:, 1] - mesh.notch[1]) < 1e-9
    ahead = np.flatnonzero(mid & (mesh.kind != Kind.NOTCH))
    ahead = ahead[np.argsort(mesh.midpoint[ahead, 0])]
    damage = np.where(mesh.kind == Kind.NOTCH, 1.0, rng.uniform(0.0, 0.4, mesh.interface_count))
    failure = np.where(mesh.kind == Kind.NOTCH, 0.0, np.nan)
    states = []
    length, cycles = mesh.notch[0], 0.0
    path = [np.array(mesh.notch)]
    for step in range(count):
        if step:
            cycles += 1000.0 * step
            broken = ahead[step - 1]
            damage[broken], failure[broken] = 1.0, cycles
            length = float(mesh.vertices[mesh.interface_vertices[broken], 0].max())
            path.append(np.array([length, mesh.notch[1]]))
        opening = np.where(mesh.centre[:, 1] > mesh.notch[1], 1.0, -1.0) * (1.0 + step)
        motion = np.stack([np.zeros_like(opening), opening, rng.uniform(-0.05, 0.05, len(opening))])
        states.append(
            GrowthState(
                mesh=mesh,
                cycles=cycles,
                crack=Crack(
                    length, (length, mesh.notch[1]), np.array(path), length - mesh.notch[0], step
                ),
                displacement=motion.T.copy(),
                damage=damage.copy(),
                normal_stress=rng.uniform(0.0, 900.0, mesh.interface_count),
                shear_stress=rng.uniform(-100.0, 100.0, mesh.interface_count),
                failure_cycles=failure.copy(),
                loose=np.zeros(mesh.element_count, dtype=bool),
                solves=step + 1,
            )
        )
    return states


SPEED = {
    "undeformed": 1.0,
    "moderate_AT": 1.6,
    "severe_AT": 1.8,
    "moderate_TA": 0.3,
    "severe_TA": 0.15,
}
TORTUOSITY = {
    "undeformed": 1.5,
    "moderate_AT": 1.3,
    "severe_AT": 1.15,
    "moderate_TA": 1.6,
    "severe_TA": 1.7,
}


def outcomes(
    delta_k: tuple[float, ...] = (8e3, 12e3, 18e3, 25e3), meshes: int = 4, seed: int = 5
) -> list[Outcome]:
    """Return tasks whose rates follow Delta-K^3 times the state's speed, with scatter."""
    rng = np.random.default_rng(seed)
    tasks = []
    for state, speed in SPEED.items():
        for mesh in range(meshes):
            luck = float(np.exp(0.4 * rng.standard_normal()))
            for value in delta_k:
                tasks.append(_task(rng, state, mesh, value, speed * luck * (value / 2e4) ** 3))
    return tasks


def _task(rng: np.random.Generator, state: str, mesh: int, delta_k: float, da_dn: float) -> Outcome:
    steps = np.concatenate([[0.0], np.cumsum(rng.uniform(0.5, 3.0, 40))])
    x = 80.0 + steps * (60.0 / steps[-1])
    y = 100.0 + np.concatenate([[0.0], np.cumsum(rng.uniform(-1.5, 1.5, 40))])
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    cycles = (x - 80.0) / da_dn
    return Outcome(
        state=state,
        mesh_index=mesh,
        delta_k=delta_k,
        stop_reason=StopReason.GROWN,
        cycles=float(cycles[-1]),
        extension=60.0,
        da_dn=da_dn,
        tortuosity=TORTUOSITY[state] + 0.03 * float(rng.standard_normal()),
        history=np.stack(
            [
                cycles,
                x,
                way,
                np.arange(41.0),
                *np.outer([0.9, 0.1, 0.01], np.linspace(1.0, 1.1, 41)),
            ],
            axis=1,
        ),
        effort=Effort(90, 3, {"iterations": 1800.0, "direct": 0.0}, 1.5, 900),
        shape=CrackShape(np.stack([x, y], axis=1), np.sort(rng.integers(0, 4000, (40, 2)), axis=1)),
    )
