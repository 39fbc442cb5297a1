"""The keys of a scene file: names, types, limits, units, defaults and what they mean.

Reading, writing and the JSON schema all follow ``TABLES`` and ``STATE_KEYS``; to add a key, add
the attribute to its dataclass in ``scene`` and one line here.
"""

from dataclasses import dataclass
from typing import Any, Literal

from pearlite_petsc import scene

Type = Literal["number", "integer", "boolean", "text", "numbers"]
NAME_PATTERN = "[A-Za-z0-9][A-Za-z0-9_+-]{0,59}"


@dataclass(frozen=True, slots=True)
class Limits:
    """Range of a number in the file's unit; an end is excluded where it is ``open``."""

    low: float
    high: float
    open_low: bool = False
    open_high: bool = False

    def hold(self, value: Any) -> bool:
        """Return whether the number lies inside; False for NaN."""
        above = value > self.low if self.open_low else value >= self.low
        below = value < self.high if self.open_high else value <= self.high
        return bool(above and below)

    def __str__(self) -> str:
        low = f"above {self.low:.12g}" if self.open_low else f"at least {self.low:.12g}"
        high = f"below {self.high:.12g}" if self.open_high else f"at most {self.high:.12g}"
        return f"{low} and {high}"


@dataclass(frozen=True, slots=True)
class Key:
    """One key of a table.

    Attributes:
        name: In the file, with its unit at the end.
        attribute: Of the table's dataclass.
        type: "numbers" is a list of them.
        default: In the file's unit.
        help: What it means, with the unit; the comment beside it in written scenes.
        power: The program's value is the file's value times 10**power.
        limits: Of a number, an integer or each of several numbers, in the file's unit.
        choices: Words that are allowed, all if empty.
    """

    name: str
    attribute: str
    type: Type
    default: Any
    help: str
    power: int = 0
    limits: Limits | None = None
    choices: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Table:
    """One table of the file; its name is the attribute of ``scene.Scene``."""

    name: str
    build: type
    help: str
    keys: tuple[Key, ...]


LENGTH = Limits(0.01, 1e5)
SHARE = Limits(0.0, 1.0, open_low=True)


def _number(
    name: str, attribute: str, default: float, help: str, limits: Limits, power: int = 0
) -> Key:
    return Key(name, attribute, "number", default, help, power, limits)


def _integer(name: str, default: int, help: str, low: int, high: int) -> Key:
    return Key(name, name, "integer", default, help, 0, Limits(low, high))


def _word(name: str, help: str, *choices: str) -> Key:
    return Key(name, name, "text", choices[0], help, choices=choices)


TABLES: tuple[Table, ...] = (
    Table(
        "microstructure",
        scene.Microstructure,
        "mean equivalent circle diameters before shear",
        (
            _number(
                "prior_austenite_grain_um", "prior_austenite_grain", 60.0, "grains, um", LENGTH
            ),
            _number("block_um", "block", 30.0, "blocks, at most a grain, um", LENGTH),
            _number("colony_um", "colony", 15.0, "colonies, at most a block, um", LENGTH),
            _integer("seed", 1, "of every random stream", 0, 2**53 - 1),
        ),
    ),
    Table(
        "window",
        scene.Window,
        "the notch enters from the left at half height",
        (
            _number("width_um", "width", 200.0, "along the crack, um", LENGTH),
            _number("height_um", "height", 200.0, "along the load, um", LENGTH),
            _number("notch_um", "notch", 80.0, "length of the notch, um", LENGTH),
        ),
    ),
    Table(
        "elements",
        scene.Elements,
        "rigid Voronoi elements, aligned with the lamellae",
        (
            _number("width_um", "width", 2.0, "across the lamellae, um", LENGTH),
            _number("length_um", "length", 4.0, "along the lamellae, um", LENGTH),
            _word(
                "refinement",
                'where elements are fine: "follow" the crack, "corridor", "uniform"',
                "follow",
                "corridor",
                "uniform",
            ),
            _number(
                "radius_um", "radius", 18.0, 'fine zone round the crack ("follow"), um', LENGTH
            ),
            _number("corridor_um", "corridor", 30.0, 'half height of the "corridor", um', LENGTH),
            _number(
                "coarsening",
                "coarsening",
                0.08,
                "growth of the spacing with the distance, 1/um",
                Limits(0.0, 100.0),
            ),
            _number(
                "coarsest",
                "coarsest",
                8.0,
                "largest spacing, in fine spacings",
                Limits(1.0, 1000.0),
            ),
            _word(
                "shear",
                '"remesh": mesh the sheared window; "affine": shear the vertices',
                "remesh",
                "affine",
            ),
        ),
    ),
    Table(
        "material",
        scene.Material,
        "elastic constants, plane stress",
        (
            _number(
                "youngs_modulus_gpa",
                "youngs_modulus",
                206.0,
                "E, GPa",
                Limits(1e-3, 1e5),
                power=3,
            ),
            _number(
                "poisson_ratio",
                "poisson_ratio",
                0.3,
                'nu; below 1/3 with "raje"',
                Limits(-1.0, 0.5, open_low=True, open_high=True),
            ),
            _word(
                "springs",
                '"homogeneous", "matched" (meets nu) or "raje", Eq. (24)-(25)',
                "homogeneous",
                "matched",
                "raje",
            ),
        ),
    ),
    Table(
        "damage",
        scene.Damage,
        "Eq. (26)-(32)",
        (
            _word("law", '"objective" (any element size) or "printed"', "objective", "printed"),
            _number(
                "c_um5_per_n2",
                "c",
                4410.0,
                "C of Eq. (28), um^5/N^2",
                Limits(1e-12, 1e24),
                power=-12,
            ),
            _number(
                "reference_length_um",
                "reference_length",
                30.0,
                'interface length at which both laws agree ("objective"), um',
                LENGTH,
            ),
            _number("beta", "beta", 0.3, "weight of the shear part, Eq. (32)", Limits(0.0, 100.0)),
            _number(
                "cementite_strength_gpa",
                "cementite_strength",
                20.0,
                "sigma_c, across lamellae, GPa",
                Limits(1e-3, 1e5),
                power=3,
            ),
            _word(
                "stress",
                "of a damaged interface: on the area left, or on all of it",
                "effective",
                "nominal",
            ),
            _word("threshold", "stress taken at the crack tip or remote", "tip", "remote"),
            _number(
                "failure_damage",
                "failure_damage",
                0.99,
                'D_c at which an interface breaks, below 1 ("nominal" only)',
                SHARE,
            ),
        ),
    ),
    Table(
        "loading",
        scene.Loading,
        "",
        (
            _word(
                "kind",
                '"k_field": tractions of the wanted K; "edge_crack": uniform remote stress',
                "k_field",
                "edge_crack",
            ),
            _word(
                "control",
                'what stays constant; "stress" only with "edge_crack"',
                "K",
                "stress",
            ),
            Key(
                "delta_k_mpa_sqrt_m",
                "delta_k",
                "numbers",
                (8.0, 12.0, 18.0, 25.0),
                "one task for each and mesh, MPa sqrt(m)",
                3,
                Limits(1e-3, 1e4),
            ),
            _number(
                "load_ratio",
                "load_ratio",
                0.1,
                "R, smallest over largest load",
                Limits(0.0, 1.0, open_high=True),
            ),
            _number("extension_um", "extension", 60.0, "wanted growth of the crack, um", LENGTH),
        ),
    ),
    Table(
        "cycle_jump",
        scene.CycleJump,
        "",
        (
            _word(
                "method",
                '"compliance", "exponential", "euler" (the source), "heun", "adaptive"',
                "compliance",
                "exponential",
                "euler",
                "heun",
                "adaptive",
            ),
            _number(
                "delta_d",
                "delta_d",
                1.0,
                "largest increment of a block: damage, or released force (compliance)",
                Limits(1e-4, 1.0),
            ),
            _number(
                "tolerance",
                "tolerance",
                0.02,
                'error of a block in damage ("adaptive")',
                Limits(1e-6, 1.0),
            ),
        ),
    ),
    Table(
        "solver",
        scene.Solver,
        "",
        (
            _word(
                "method",
                'CG with "factors" (of an earlier matrix) or GAMG ("iterative"), "auto" by size, or "direct"',
                "auto",
                "iterative",
                "factors",
                "direct",
            ),
            _number(
                "relative_tolerance",
                "relative_tolerance",
                1e-9,
                "of the residual",
                Limits(1e-14, 0.1),
            ),
            _integer("max_solves", 20000, "a task", 1, 10**7),
        ),
    ),
    Table(
        "ensemble",
        scene.Ensemble,
        "",
        (
            _integer("meshes", 4, "repetitions a state", 1, 100_000),
            _integer("ranks_per_task", 1, "MPI ranks that share a task", 1, 100_000),
        ),
    ),
    Table(
        "output",
        scene.Output,
        "",
        (
            _word(
                "fields",
                'ParaView files of the "first" mesh a state, "all" tasks or "none"',
                "first",
                "all",
                "none",
            ),
            _integer("field_steps", 20, "moments in each of them", 1, 10_000),
            Key("figures", "figures", "boolean", True, "draw the figures"),
            Key("experiment", "experiment", "text", "", 'CSV of measured points, "" for none'),
        ),
    ),
)

STATE_KEYS: tuple[Key, ...] = (
    _number("shear_strain", "shear_strain", 0.0, "gamma", Limits(0.0, 1000.0)),
    Key(
        "orientation",
        "orientation",
        "text",
        "AT",
        'crack plane: "AT" parallel to the shear plane, "TA" across it',
        choices=("AT", "TA"),
    ),
    _number("yield_stress_mpa", "yield_stress", 470.0, "sigma_yield, MPa", Limits(1e-2, 1e6)),
    _number(
        "delta_k_th_mpa_sqrt_m",
        "delta_k_th",
        5.0,
        "threshold of growth, 0 for none, MPa sqrt(m)",
        Limits(0.0, 1e3),
        power=3,
    ),
)

SOURCE_STATES: dict[str, dict[str, Any]] = {
    name: dict(zip((key.name for key in STATE_KEYS), values, strict=True))
    for name, values in {
        "undeformed": (0.0, "AT", 470.0, 5.0),
        "moderate_AT": (2.0, "AT", 616.0, 4.0),
        "severe_AT": (30.0, "AT", 1024.0, 2.3),
        "moderate_TA": (2.0, "TA", 616.0, 4.0),
        "severe_TA": (30.0, "TA", 1024.0, 2.3),
    }.items()
}
"""The source's five states, in the file's units: defaults of [states] and of these names."""
