"""The tables of a scene file: their keys, and the laws that a scene chooses in them.

Reading, writing and the JSON schema all follow ``tables`` and ``STATE_KEYS``; to add a key, add
the attribute to its dataclass in ``scene`` and one line here.
"""

from pearlite_petsc import scene
from pearlite_petsc.config.shipped import SHIPPED
from pearlite_petsc.config.table import Table, law_key
from pearlite_petsc.laws.catalogue import Laws
from pearlite_petsc.laws.cycle_jump import CycleJumpLaw
from pearlite_petsc.laws.damage import DamageLaw
from pearlite_petsc.laws.key import LENGTH, SHARE, Key, Limits, integer, number, switch, word
from pearlite_petsc.laws.law import Law
from pearlite_petsc.laws.springs import SpringLaw

NAME_PATTERN = "[A-Za-z0-9][A-Za-z0-9_+-]{0,59}"


def tables(laws: Laws) -> tuple[Table, ...]:
    """Return the tables of scenes that may choose from a catalogue of laws."""
    return (
        *_window(),
        _elements(),
        _material(laws.of(SpringLaw)),
        _damage(laws.of(DamageLaw)),
        _loading(),
        _cycle_jump(laws.of(CycleJumpLaw)),
        *_run(),
    )


def _window() -> tuple[Table, ...]:
    return (
        Table(
            "microstructure",
            scene.Microstructure,
            "mean equivalent circle diameters before shear",
            (
                number("prior_austenite_grain", 60.0, "grains, um", LENGTH, "um"),
                number("block", 30.0, "blocks, at most a grain, um", LENGTH, "um"),
                number("colony", 15.0, "colonies, at most a block, um", LENGTH, "um"),
                integer("seed", 1, "seed of every random stream", 0, 2**53 - 1),
            ),
        ),
        Table(
            "window",
            scene.Window,
            "the notch enters from the left at half height",
            (
                number("width", 200.0, "along the crack, um", LENGTH, "um"),
                number("height", 200.0, "along the load, um", LENGTH, "um"),
                number("notch", 80.0, "length of the notch, um", LENGTH, "um"),
            ),
        ),
    )


def _material(laws: tuple[Law, ...]) -> Table:
    return Table(
        "material",
        scene.Material,
        "elastic constants, plane stress",
        (
            number("youngs_modulus", 206.0, "E, GPa", Limits(1e-3, 1e5), "gpa"),
            number(
                "poisson_ratio",
                0.3,
                'nu; below 1/3 with "raje"',
                Limits(-1.0, 0.5, open_low=True, open_high=True),
            ),
            law_key("springs", laws),
            number(
                "fracture_toughness",
                40.0,
                "a warning names each K_max above it; no rate depends on it, MPa sqrt(m)",
                Limits(1.0, 1e4),
                "mpa_sqrt_m",
            ),
        ),
        laws,
    )


def _cycle_jump(laws: tuple[Law, ...]) -> Table:
    return Table(
        "cycle_jump",
        scene.CycleJump,
        "",
        (
            law_key("method", laws),
            number(
                "delta_d",
                1.0,
                "largest increment in a block: damage, or released force (compliance)",
                Limits(1e-4, 1.0),
            ),
            number("tolerance", 0.02, 'error of a block in damage ("adaptive")', Limits(1e-6, 1.0)),
        ),
        laws,
    )


def _elements() -> Table:
    return Table(
        "elements",
        scene.Elements,
        "rigid Voronoi elements, aligned with the lamellae",
        (
            number("width", 2.0, "across the lamellae, um", LENGTH, "um"),
            number("length", 4.0, "along the lamellae, um", LENGTH, "um"),
            word(
                "refinement",
                'where elements are fine: round the crack ("follow"), "corridor", "uniform"',
                "follow",
                "corridor",
                "uniform",
            ),
            number("radius", 18.0, 'fine zone round the crack ("follow"), um', LENGTH, "um"),
            number("corridor", 30.0, 'half height of the "corridor", um', LENGTH, "um"),
            number(
                "coarsening",
                0.08,
                "growth of the spacing with the distance, 1/um",
                Limits(0.0, 100.0),
            ),
            number("coarsest", 8.0, "largest spacing, in fine spacings", Limits(1.0, 1000.0)),
            word(
                "shear",
                '"remesh": mesh the sheared window; "affine": shear the vertices',
                "remesh",
                "affine",
            ),
            word(
                "kinds",
                'interfaces by the "labels" of their elements, or by what they "cut" on the label map',
                "labels",
                "cut",
            ),
            word("wake", 'elements far behind the tip ("follow")', "fine", "coarse"),
        ),
    )


def _damage(laws: tuple[Law, ...]) -> Table:
    return Table(
        "damage",
        scene.Damage,
        "Eq. (26)-(32)",
        (
            law_key("law", laws),
            number("c", 4410.0, "C of Eq. (28), um^5/N^2", Limits(1e-12, 1e24), "um5_per_n2"),
            number(
                "reference_length",
                30.0,
                'interface length at which both laws agree ("objective"), um',
                LENGTH,
                "um",
            ),
            number("beta", 0.3, "weight of the shear part, Eq. (32)", Limits(0.0, 100.0)),
            number(
                "cementite_strength",
                20.0,
                "sigma_c, across lamellae, GPa",
                Limits(1e-3, 1e5),
                "gpa",
            ),
            word(
                "stress",
                "stress of a damaged interface: on the area left, or on all of it",
                "effective",
                "nominal",
            ),
            word("threshold", "stress taken at the crack tip or remote", "tip", "remote"),
            number(
                "failure_damage",
                0.99,
                'D_c at which an interface breaks, below 1 ("nominal" only)',
                SHARE,
            ),
        ),
        laws,
    )


def _loading() -> Table:
    return Table(
        "loading",
        scene.Loading,
        "",
        (
            word(
                "kind",
                '"k_field": tractions of the wanted K; "edge_crack": uniform remote stress',
                "k_field",
                "edge_crack",
            ),
            word("control", 'what stays constant; "stress" only with "edge_crack"', "K", "stress"),
            Key(
                "delta_k_mpa_sqrt_m",
                "delta_k",
                "numbers",
                (8.0, 12.0, 18.0, 25.0),
                "one task per value and mesh, MPa sqrt(m)",
                3,
                Limits(1e-3, 1e4),
            ),
            number(
                "load_ratio",
                0.1,
                "R, smallest over largest load",
                Limits(0.0, 0.95),
            ),
            number("extension", 60.0, "wanted growth of the crack, um", LENGTH, "um"),
        ),
    )


def _run() -> tuple[Table, ...]:
    """Return the tables of what is no physics."""
    return (
        Table(
            "solver",
            scene.Solver,
            "",
            (
                word(
                    "method",
                    'CG with "factors" (of an earlier matrix) or GAMG ("iterative"), "auto" by size, or "direct"',
                    "auto",
                    "iterative",
                    "factors",
                    "direct",
                ),
                number("relative_tolerance", 1e-9, "of the residual", Limits(1e-14, 0.1)),
                integer("max_solves", 20000, "limit of linear solves per task", 1, 10**7),
            ),
        ),
        Table(
            "ensemble",
            scene.Ensemble,
            "",
            (
                integer("meshes", 4, "repetitions per state", 1, 100_000),
                integer("ranks_per_task", 1, "MPI ranks that share a task", 1, 100_000),
            ),
        ),
        Table(
            "output",
            scene.Output,
            "",
            (
                word(
                    "fields",
                    'ParaView files of the "first" mesh per state, "all" tasks or "none"',
                    "first",
                    "all",
                    "none",
                ),
                integer("field_steps", 20, "steps in each of these files", 1, 10_000),
                switch("figures", True, "draw the figures"),
                Key("experiment", "experiment", "text", "", 'CSV of measured points, "" for none'),
            ),
        ),
    )


TABLES = tables(SHIPPED)
"""The tables of scenes that choose from the laws shipped."""
