"""Laws as plug-ins: what a damage, spring or cycle jump law declares, and the catalogue of laws."""

from pearlite_petsc.laws.catalogue import Laws
from pearlite_petsc.laws.cycle_jump import CycleJumpLaw
from pearlite_petsc.laws.damage import DamageInterfaces, DamageLaw, RateConstants, cubic_rate
from pearlite_petsc.laws.key import LENGTH, SHARE, Key, Limits, integer, number, switch, word
from pearlite_petsc.laws.law import Law, Source
from pearlite_petsc.laws.springs import SpringInterfaces, SpringLaw

__all__ = [
    "LENGTH",
    "SHARE",
    "CycleJumpLaw",
    "DamageInterfaces",
    "DamageLaw",
    "Key",
    "Law",
    "Laws",
    "Limits",
    "RateConstants",
    "Source",
    "SpringInterfaces",
    "SpringLaw",
    "cubic_rate",
    "integer",
    "number",
    "switch",
    "word",
]
