"""The laws that a scene may choose from."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeVar

from pearlite_petsc.errors import SceneError
from pearlite_petsc.laws.law import Law, described

LawType = TypeVar("LawType", bound=Law)


@dataclass(frozen=True, slots=True)
class Laws:
    """A catalogue of laws. It is immutable: adding a law gives another catalogue.

    Attributes:
        laws: The laws, in the order in which messages and pages name them; the first of each type
            is the default.
        unusable: One sentence for each installed law that could not be loaded.
    """

    laws: tuple[Law, ...]
    unusable: tuple[str, ...] = ()

    def of(self, kind: type[LawType]) -> tuple[LawType, ...]:
        """Return the laws of one type."""
        return tuple(law for law in self.laws if isinstance(law, kind))

    def named(self, kind: type[LawType], name: str) -> LawType:
        """Return the law with this type and name.

        Raises:
            KeyError: There is no such law.
        """
        for law in self.of(kind):
            if law.name == name:
                return law
        raise KeyError(name)

    def joined(self, laws: Iterable[Law]) -> "Laws":
        """Return a catalogue that holds these laws as well.

        Raises:
            SceneError: There already is a law of this type and name.
        """
        found = list(self.laws)
        for law in laws:
            for other in found:
                if (other.table, other.name) == (law.table, law.name):
                    place = other.source.file if other.source else "the program itself"
                    raise SceneError(f"{described(law)}: one of this name exists in {place}")
            found.append(law)
        return Laws(tuple(found), self.unusable)
