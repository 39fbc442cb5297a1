"""One table of a scene file, and the keys by which it chooses a law."""

from dataclasses import dataclass, field

from pearlite_petsc.laws.key import Key, word
from pearlite_petsc.laws.law import Law, Source


@dataclass(frozen=True, slots=True)
class Table:
    """One table of the file; its name is the attribute of ``scene.Scene``.

    Attributes:
        name, build, help: Its name, dataclass and meaning.
        keys: Keys that are always there.
        laws: Laws of which the key ``law.key`` chooses one, whose parameters are keys too; the
            default first.
    """

    name: str
    build: type
    help: str
    keys: tuple[Key, ...]
    laws: tuple[Law, ...] = field(default=())

    @property
    def law_key(self) -> Key | None:
        """The key that chooses a law, None in a table without laws."""
        names = {law.key for law in self.laws}
        return next((key for key in self.keys if key.attribute in names), None)


def text_key(key: Key, source: Source | None = None) -> Key:
    """Return the key of the SHA-256 of the text that the chosen law comes from."""
    help = f"SHA-256 of {source.file}" if source else "SHA-256 of the text of a law of one's own"
    name = f"{key.name}_sha256"
    return Key(name, name, "text", "", help)


def law_key(attribute: str, laws: tuple[Law, ...]) -> Key:
    """Return the key that chooses one of some laws, the first by default."""
    help = ", ".join(f'"{law.name}" ({law.help})' for law in laws)
    return word(attribute, help, *(law.name for law in laws))
