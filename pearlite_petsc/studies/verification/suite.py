"""All sections by name, in the order of the report."""

from collections.abc import Callable

from pearlite_petsc.studies.verification.claim import Section, Setting
from pearlite_petsc.studies.verification.crack_tip import crack_tip
from pearlite_petsc.studies.verification.damage import damage
from pearlite_petsc.studies.verification.elastic import elastic
from pearlite_petsc.studies.verification.exact import exact
from pearlite_petsc.studies.verification.fracture import fracture
from pearlite_petsc.studies.verification.metamorphic import metamorphic
from pearlite_petsc.studies.verification.objectivity import objectivity
from pearlite_petsc.studies.verification.short_cracks import short_cracks
from pearlite_petsc.studies.verification.texture import texture

SECTIONS: dict[str, Callable[[Setting], Section]] = {
    "exact": exact,
    "elastic": elastic,
    "fracture": fracture,
    "crack_tip": crack_tip,
    "damage": damage,
    "short_cracks": short_cracks,
    "metamorphic": metamorphic,
    "texture": texture,
    "objectivity": objectivity,
}
