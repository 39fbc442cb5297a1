"""Files appear whole or not at all, in folders that can take them."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pearlite_petsc.errors import SceneError


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Yield ``<path>.partial`` to write to; it takes the place of ``path`` at the end.

    The folder is made if need be. After an error the partial file is removed and an older file of
    that name stays as it was.

    Raises:
        OSError: It cannot be written; with the name of the file, which writers leave out.
    """
    partial = path.with_name(path.name + ".partial")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            yield partial
            partial.replace(path)
        finally:
            partial.unlink(missing_ok=True)
    except OSError as error:
        if error.errno is None:
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error


def make_folder(path: Path) -> None:
    """Make an output folder if need be, before what is to go there is computed.

    Raises:
        SceneError: There is something else, or it cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unusable(path, error) from None


def unusable(path: Path, error: OSError) -> SceneError:
    """Return the error of an output folder that the system refuses."""
    return SceneError(
        f"{path}: cannot be used as output ({error.strerror}); choose another with --output"
    )
