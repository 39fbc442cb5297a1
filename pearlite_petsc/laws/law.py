"""Laws: a damage, spring or cycle jump law is a name, a function, and the parameters it declares.

A law is a value. Nothing registers itself: the catalogue used to read a scene says which laws there
are, and the scene holds those that it chose.
"""

import inspect
import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, TypeVar

from pearlite_petsc.errors import PearliteError
from pearlite_petsc.laws.key import Key

NAME_PATTERN = "[A-Za-z][A-Za-z0-9_]{0,59}"

LawType = TypeVar("LawType", bound="Law")


@dataclass(frozen=True, slots=True)
class Source:
    """The text that a law from outside the program comes from.

    Attributes:
        file: Name of the file, or of the module that an entry point names.
        sha256: SHA-256 of the text, as hexadecimal digits.
    """

    file: str
    sha256: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Law:
    """A law that a scene chooses by name.

    Two laws are equal if their names, parameters, values and source texts are equal.

    Attributes:
        name: Name of the law in scenes.
        help: One line that says what the law does.
        function: The law itself; each parameter is a keyword.
        parameters: Keys of the scene's table that belong to this law alone.
        check: Checks that the law fits the other values of its table; returns the key that does
            not fit and the reason, or None.
        values: Parameters that the scene gives, by keyword, in the program's units; those left
            out have their defaults.
        source: Where the law comes from; None for the program's own laws.
    """

    name: str
    help: str
    function: Callable[..., Any] = field(compare=False, repr=False)
    parameters: tuple[Key, ...] = ()
    check: Callable[[Any], tuple[str, str] | None] | None = field(
        default=None, compare=False, repr=False
    )
    values: tuple[tuple[str, Any], ...] = ()
    source: Source | None = None

    table: ClassVar[str]
    key: ClassVar[str]
    arguments: ClassVar[tuple[str, ...]]

    def __post_init__(self) -> None:
        if re.fullmatch(NAME_PATTERN, self.name) is None:
            text = "must be letters, digits and _ only, at most 60, a letter first"
            raise ValueError(f'name "{self.name}" {text}')
        known = [key.attribute for key in self.parameters]
        for name in {name for name in known if known.count(name) > 1}:
            raise ValueError(f'law "{self.name}": parameter {name} is declared twice')
        for name, _ in self.values:
            if name not in known:
                raise ValueError(f'law "{self.name}" has no parameter {name}')
        try:
            self.signature().bind(
                *self.arguments, **dict.fromkeys([*known, *self.given_by_program])
            )
        except TypeError as error:
            takes = ", ".join(
                [*self.arguments, *(f"{n}=" for n in [*self.given_by_program, *known])]
            )
            text = f'law "{self.name}": its function does not take ({takes}): {error}'
            raise ValueError(text) from None

    @property
    def given_by_program(self) -> tuple[str, ...]:
        """Keywords that the program passes besides the parameters."""
        return ()

    def signature(self) -> inspect.Signature:
        """Return the signature of the function."""
        return inspect.signature(self.function)

    def keywords(self) -> dict[str, Any]:
        """Return the value of every parameter in the program's unit."""
        return {key.attribute: key.program_default for key in self.parameters} | dict(self.values)

    def with_values(self: LawType, **values: Any) -> LawType:
        """Return the law with these values of its parameters, in the program's units.

        Raises:
            ValueError: The law has no such parameter.
        """
        return replace(self, values=tuple(sorted((dict(self.values) | values).items())))

    def __str__(self) -> str:
        return self.name


def called(law: Law, *arguments: Any, **more: Any) -> Any:
    """Return what the law's function returns for its parameters' values.

    Raises:
        PearliteError: The function raised an error; the message names law and file.
    """
    try:
        return law.function(*arguments, **more, **law.keywords())
    except PearliteError:
        raise
    except Exception as error:
        raise PearliteError(f"{described(law)} fails: {type(error).__name__}: {error}") from error


def described(law: Law) -> str:
    """Return the law's table, key, name and file for a message."""
    origin = f" of {law.source.file}" if law.source else ""
    return f'[{law.table}] {law.key} = "{law.name}"{origin}'
