"""The catalogue of the laws that come with the program."""

from pearlite_petsc.fatigue import damage
from pearlite_petsc.laws.catalogue import Laws

SHIPPED = Laws(damage.LAWS)
