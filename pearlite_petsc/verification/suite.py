"""All sections by name, in the order of the report."""

from collections.abc import Callable

from pearlite_petsc.verification.claim import Section, Setting
from pearlite_petsc.verification.damage import damage
from pearlite_petsc.verification.elastic import elastic
from pearlite_petsc.verification.exact import exact
from pearlite_petsc.verification.fracture import fracture
from pearlite_petsc.verification.metamorphic import metamorphic
from pearlite_petsc.verification.objectivity import objectivity
from pearlite_petsc.verification.texture import texture

SECTIONS: dict[str, Callable[[Setting], Section]] = {
    "exact": exact,
    "elastic": elastic,
    "fracture": fracture,
    "damage": damage,
    "metamorphic": metamorphic,
    "texture": texture,
    "objectivity": objectivity,
}
