"""The catalogue of the laws that come with the program."""

from pearlite_petsc.fatigue import damage
from pearlite_petsc.fatigue.cycle_jumps import shipped
from pearlite_petsc.laws.catalogue import Laws
from pearlite_petsc.mechanics import springs

SHIPPED = Laws((*damage.LAWS, *springs.LAWS, *shipped.LAWS))
