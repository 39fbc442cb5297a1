"""The Sherman-Morrison-Woodbury correction against the inverse of the changed matrix."""

import numpy as np

from pearlite_petsc.solver.woodbury import Woodbury

RNG = np.random.default_rng(8)
ELEMENTS, INTERFACES = 5, 7


def case() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return K at damage 0.2, rows B of all unknowns, B, its unknowns and the springs."""
    size = 3 * ELEMENTS
    operator = RNG.normal(size=(INTERFACES, 3, 6))
    pairs = np.array([RNG.choice(ELEMENTS, 2, replace=False) for _ in range(INTERFACES)])
    unknowns = (3 * pairs[:, :, None] + np.arange(3)).reshape(-1, 6)
    constants = RNG.uniform(1.0, 2.0, (INTERFACES, 3))
    rows = np.zeros((INTERFACES, 3, size))
    for number in range(INTERFACES):
        rows[number][:, unknowns[number]] = operator[number]
    return stiffness(rows, constants, np.full(INTERFACES, 0.2)), rows, operator, unknowns, constants


def stiffness(rows: np.ndarray, constants: np.ndarray, damage: np.ndarray) -> np.ndarray:
    springs = constants * (1.0 - damage)[:, None]
    return 0.5 * np.eye(rows.shape[2]) + np.einsum("kci,kc,kcj->ij", rows, springs, rows)


def test_corrected_solutions_are_those_of_the_softened_matrix() -> None:
    matrix, rows, operator, unknowns, constants = case()
    place = np.array([5, 1, 2])
    some = rows[place].reshape(9, -1)
    columns = np.linalg.solve(matrix, some.T)
    woodbury = Woodbury(
        place=place,
        damage=np.full(3, 0.2),
        constants=constants[place],
        compliance=some @ columns,
        operator=operator[place],
        unknowns=unknowns[place],
        columns=columns,
    )
    assert woodbury.correction(np.full(INTERFACES, 0.2)) is None
    damage = np.full(INTERFACES, 0.2)
    damage[place] = [1.0, 0.2, 0.7]
    correction = woodbury.correction(damage)
    assert correction is not None
    load = RNG.normal(size=3 * ELEMENTS)
    old = np.linalg.solve(matrix, load)
    exact = np.linalg.solve(stiffness(rows, constants, damage), load)
    assert np.abs(old - exact).max() > 1e-2 * np.abs(exact).max()
    assert np.abs(old + correction(old) - exact).max() < 1e-12 * np.abs(exact).max()


def test_what_cannot_be_inverted_is_left_uncorrected() -> None:
    one = Woodbury(
        place=np.array([0]),
        damage=np.zeros(1),
        constants=np.ones((1, 3)),
        compliance=np.eye(3),
        operator=np.zeros((1, 3, 6)),
        unknowns=np.arange(6)[None],
        columns=np.zeros((6, 3)),
    )
    assert one.correction(np.ones(1)) is None
    assert one.correction(np.full(1, 0.5)) is not None
