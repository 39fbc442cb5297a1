"""Laws from outside the program: files that a user names, and entry points of installed packages.

Such a file or module has a list ``LAWS`` of ``DamageLaw``, ``SpringLaw`` and ``CycleJumpLaw``. Each
law is found under its name, and carries the SHA-256 of the text that it comes from.
"""

import hashlib
import importlib
import sys
from collections.abc import Iterable
from dataclasses import replace
from importlib.metadata import EntryPoint, entry_points
from os import PathLike
from pathlib import Path
from types import ModuleType
from typing import Any

from pearlite_petsc.config.shipped import SHIPPED
from pearlite_petsc.config.values import plain
from pearlite_petsc.errors import SceneError
from pearlite_petsc.laws.catalogue import Laws
from pearlite_petsc.laws.law import Law, Source

GROUP = "pearlite_petsc.laws"
"""Group of entry points, each the name of a module with ``LAWS``."""

LARGEST_FILE = 1_000_000


def find_laws(files: Iterable[str | PathLike[str]] = ()) -> Laws:
    """Return the laws shipped, those of installed packages, and those of some files.

    A package whose laws cannot be loaded does not stop a run that asks for none of them; the
    catalogue says why.

    Args:
        files: Python files with ``LAWS``.

    Raises:
        SceneError: A file cannot be used, or two laws of one type have one name; one line.
    """
    laws = SHIPPED
    for point in sorted(entry_points(group=GROUP), key=lambda point: point.name):
        try:
            laws = laws.joined(_laws_of_package(point))
        except SceneError as error:
            laws = replace(laws, unusable=(*laws.unusable, str(error)))
    for file in files:
        laws = laws.joined(laws_of_file(Path(file)))
    return laws


def laws_of_file(path: Path) -> tuple[Law, ...]:
    """Return the laws of a Python file.

    Raises:
        SceneError: It cannot be read, fails, or has no laws; one line with file and line number.
    """
    name = plain(str(path))
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise SceneError(f"{name}: is not a file of laws: more than {LARGEST_FILE} bytes")
        text = path.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SceneError(f"{name}: cannot be read: {reason}") from None
    sha256 = hashlib.sha256(text).hexdigest()
    # Named by its content, so that no two texts meet under one name.
    module_name = f"pearlite_law_{sha256}"
    module = sys.modules.get(module_name)
    if module is None:
        module = ModuleType(module_name)
        module.__file__ = str(path.absolute())
        # Dataclasses and pickle look for the module by its name.
        sys.modules[module_name] = module
        try:
            exec(compile(text, module.__file__, "exec"), module.__dict__)
        except (Exception, SystemExit) as error:
            del sys.modules[module_name]
            raise SceneError(f"{name}: {_what_failed(error, module.__file__)}") from None
    return _declared(module, name, Source(name, sha256))


def _laws_of_package(point: EntryPoint) -> tuple[Law, ...]:
    package = "" if point.dist is None else f" of {point.dist.name} {point.dist.version}"
    name = plain(f"entry point {point.name}{package}")
    try:
        module = importlib.import_module(point.module)
        text = Path(str(module.__file__)).read_bytes()
    except (Exception, SystemExit) as error:
        raise SceneError(f"{name}: {_what_failed(error)}") from None
    return _declared(module, name, Source(point.module, hashlib.sha256(text).hexdigest()))


def _declared(module: ModuleType, name: str, source: Source) -> tuple[Law, ...]:
    """Return the laws that a module declares, with where they come from."""
    laws: Any = getattr(module, "LAWS", None)
    types = "DamageLaw, SpringLaw or CycleJumpLaw"
    if not isinstance(laws, list | tuple) or not laws:
        raise SceneError(f"{name}: has no laws: LAWS must be a list of {types}")
    for law in laws:
        if not isinstance(law, Law) or not hasattr(law, "table"):
            raise SceneError(f"{name}: LAWS holds {plain(repr(law), 60)}, which is not a {types}")
    return tuple(replace(law, source=source) for law in laws)


def _what_failed(error: BaseException, file: str = "") -> str:
    """Return an error in one line, with the line of the file that led to it."""
    lines = []
    if isinstance(error, SyntaxError):
        lines = [error.lineno] if error.lineno else []
        text = error.msg
    else:
        trace = error.__traceback__
        while trace is not None:
            if trace.tb_frame.f_code.co_filename == file:
                lines = [trace.tb_lineno]
            trace = trace.tb_next
        text = str(error)
    where = f"line {lines[0]}: " if lines else ""
    return plain(f"{where}{type(error).__name__}: {' '.join(text.split())}", 400)
