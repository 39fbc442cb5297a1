"""The package's source as syntax trees: its modules, their imports, functions and classes."""

import ast
import functools
from collections.abc import Iterator
from pathlib import Path

PACKAGE = "pearlite_petsc"
ROOT = Path(__file__).parents[1]


def module_name(file: Path) -> str:
    """Return the dotted name of a file of the package."""
    parts = file.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {module_name(file): file for file in sorted((ROOT / PACKAGE).rglob("*.py"))}
TEST_FILES = sorted((ROOT / "tests").rglob("*.py"))


@functools.cache
def tree(file: Path) -> ast.Module:
    return ast.parse(file.read_text(encoding="utf-8"), str(file))


def library(name: str) -> str:
    """Return the first part of a dotted name."""
    return name.partition(".")[0]


def _targets(module: str, node: ast.AST) -> Iterator[str]:
    """Yield the full names that an import statement asks for."""
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        assert node.level == 0, f"{module}: imports name the package in full"
        yield node.module or ""
        yield from (f"{node.module}.{alias.name}" for alias in node.names)


@functools.cache
def imports(module: str) -> frozenset[str]:
    """Return all that a module imports anywhere, with the names taken from there."""
    nodes = ast.walk(tree(MODULES[module]))
    return frozenset(name for node in nodes for name in _targets(module, node))


@functools.cache
def imports_at_start(module: str) -> frozenset[str]:
    """Return what importing a module imports: not what functions or type checkers do."""
    names: set[str] = set()

    def visit(node: ast.AST) -> None:
        names.update(_targets(module, node))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            return
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            for statement in node.orelse:
                visit(statement)
            return
        for child in ast.iter_child_nodes(node):
            visit(child)

    visit(tree(MODULES[module]))
    return frozenset(names)


def own_modules(names: frozenset[str]) -> set[str]:
    """Return the modules of the package among imported names, without the package itself."""
    found = set()
    for name in names:
        while name not in MODULES and name:
            name = name.rpartition(".")[0]
        found.add(name)
    return found - {"", PACKAGE}


def names_used(module: str) -> set[str]:
    """Return every name and attribute that stands in a module."""
    used = set()
    for node in ast.walk(tree(MODULES[module])):
        if isinstance(node, ast.Attribute):
            used.add(node.attr)
        elif isinstance(node, ast.Name):
            used.add(node.id)
        elif isinstance(node, ast.alias):
            used.add(node.name)
    return used


def lines_of_code(function: ast.FunctionDef | ast.AsyncFunctionDef, file: Path) -> int:
    """Return the lines of a function without docstring, comments and empty ones."""
    lines = file.read_text(encoding="utf-8").splitlines()
    count = range(function.lineno, (function.end_lineno or function.lineno) + 1)
    docstring: range = range(0)
    if ast.get_docstring(function) is not None:
        first = function.body[0]
        docstring = range(first.lineno, (first.end_lineno or first.lineno) + 1)
    code = (lines[number - 1].strip() for number in count if number not in docstring)
    return sum(bool(line) and not line.startswith("#") for line in code)


def methods(owner: ast.ClassDef) -> int:
    return sum(isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) for node in owner.body)


def fields(owner: ast.ClassDef) -> set[str]:
    """Return the fields of a dataclass, none of any other class."""
    if not any("dataclass" in ast.dump(decorator) for decorator in owner.decorator_list):
        return set()
    return {
        node.target.id
        for node in owner.body
        if isinstance(node, ast.AnnAssign)
        and isinstance(node.target, ast.Name)
        and "ClassVar" not in ast.dump(node.annotation)
    }


def bound_attributes(owner: ast.ClassDef) -> set[str]:
    """Return the attributes that the methods of a class bind to its objects."""
    return {
        node.attr
        for node in ast.walk(owner)
        if isinstance(node, ast.Attribute)
        and isinstance(node.ctx, ast.Store)
        and isinstance(node.value, ast.Name)
        and node.value.id == "self"
    }
