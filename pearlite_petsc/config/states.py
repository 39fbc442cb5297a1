"""The keys of a state of the steel, and the source's five states."""

from typing import Any

from pearlite_petsc.laws.key import Key, Limits, number, word

STATE_KEYS: tuple[Key, ...] = (
    number("shear_strain", 0.0, "gamma", Limits(0.0, 1000.0)),
    word(
        "orientation",
        'crack plane: "AT" parallel to the shear plane, "TA" across it',
        "AT",
        "TA",
    ),
    number("yield_stress", 470.0, "sigma_yield, MPa", Limits(1e-2, 1e6), "mpa"),
    number(
        "delta_k_th",
        5.0,
        "threshold of growth, 0 for none, MPa sqrt(m)",
        Limits(0.0, 1e3),
        "mpa_sqrt_m",
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
