"""A damage law of one's own: the rate goes with any power of the stress, not only with the third.

``dD/dN = C/(S L) (L/l_ref)^(m/2) s_ref^(3-m) <dsigma - dsigma_th>^m``: at m = 3 the program's law
``objective``; at any m the rate of a crack does not depend on the size of the elements, and without
a threshold da/dN goes with Delta-K^m.
"""

from functools import partial

import numpy as np

from pearlite_petsc.fatigue.damage import threshold_stress
from pearlite_petsc.laws import DamageLaw, Limits, RateConstants, number


def power_rate(stress, threshold, factor, exponent):
    """Return factor <stress - threshold>^m."""
    return factor * np.maximum(stress - threshold, 0.0) ** exponent


def power_law(interfaces, damage, *, exponent, reference_stress):
    """Return the constants of the rate C/(S L) (L/l_ref)^(m/2) s_ref^(3-m) <dsigma - dsigma_th>^m."""
    length = interfaces.length
    factor = damage.c / (interfaces.strength * length)
    factor = factor * (length / damage.reference_length) ** (0.5 * exponent)
    return RateConstants(
        factor * reference_stress ** (3.0 - exponent),
        threshold_stress(interfaces, damage),
        damage.beta,
        partial(power_rate, exponent=exponent),
    )


LAWS = [
    DamageLaw(
        name="power_law",
        help="rate with the m-th power of the stress",
        function=power_law,
        parameters=(
            number("exponent", 4.0, "m", Limits(1.0, 8.0)),
            number(
                "reference_stress",
                2000.0,
                "s_ref, stress at l_ref at which all m give one rate, MPa",
                Limits(1.0, 1e5),
                "mpa",
            ),
        ),
    )
]
