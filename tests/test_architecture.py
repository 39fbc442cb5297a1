"""The layers of the package, read from its imports: nothing points back, each library in its place.

Layers from bottom to top: types and plugs of laws; microstructure; elements; mechanics; fatigue;
scene files (which know the laws shipped); solver; the growth of one crack; output; the ensemble;
studies (verification, benchmarks); what commands share; commands.
"""

import ast
import functools
from collections.abc import Iterator
from pathlib import Path

import pytest

from pearlite_petsc.__main__ import COMMANDS as COMMANDS_LISTED
from pearlite_petsc.bench import SUBCOMMANDS

PACKAGE = "pearlite_petsc"
ROOT = Path(__file__).parents[1]
FILES = sorted((ROOT / PACKAGE).rglob("*.py"))
ORDER = (
    {"arrays", "errors", "exit_status", "laws", "scene", "world"},
    {"microstructure"},
    {"tessellation"},
    {"mechanics"},
    {"fatigue"},
    {"config"},
    {"solver"},
    {"growth"},
    {"output"},
    {"ensemble"},
    {"studies"},
    {"command_line"},
)
LAYER = {name: layer for layer, names in enumerate(ORDER) for name in names}
COMMANDS = {name.replace("-", "_") for name in COMMANDS_LISTED} | {"__main__"}
STUDY_COMMANDS = {"verify", "bench"}
PARALLEL = {"mpi4py", "petsc4py"}
FORBIDDEN = {
    "config": PARALLEL | {"h5py", "meshio", "matplotlib"},
    "microstructure": PARALLEL | {"h5py", "meshio", "matplotlib"},
    "tessellation": PARALLEL | {"h5py", "meshio", "matplotlib"},
    "mechanics": PARALLEL | {"h5py", "meshio", "matplotlib"},
    "fatigue": PARALLEL | {"h5py", "meshio", "matplotlib"},
    "output": PARALLEL,
}
MOST_LINES = 400


def module_name(file: Path) -> str:
    parts = file.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def part(module: str) -> str:
    """Return the package's part that a module belongs to, empty for the package itself."""
    return module.split(".")[1] if "." in module else ""


def layer(module: str) -> int:
    return LAYER.get(part(module), len(ORDER))


@functools.cache
def tree(file: Path) -> ast.Module:
    return ast.parse(file.read_text(), str(file))


def targets(file: Path, node: ast.AST) -> Iterator[str]:
    """Yield the full names that an import statement asks for."""
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        base = node.module or ""
        if node.level:
            package = module_name(file).split(".")
            if file.name != "__init__.py":
                package = package[:-1]
            base = ".".join([*package[: len(package) - node.level + 1], *([base] if base else [])])
        yield base
        yield from (f"{base}.{alias.name}" for alias in node.names)


def imports(file: Path) -> set[str]:
    return {name for node in ast.walk(tree(file)) for name in targets(file, node)}


def imports_at_start(file: Path) -> set[str]:
    """Return what importing the file imports: not what functions or type checkers do."""
    names: set[str] = set()

    def visit(node: ast.AST) -> None:
        names.update(targets(file, node))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            return
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            for statement in node.orelse:
                visit(statement)
            return
        for child in ast.iter_child_nodes(node):
            visit(child)

    visit(tree(file))
    return names


def library(name: str) -> str:
    return name.split(".")[0]


def names_used(file: Path) -> set[str]:
    used = set()
    for node in ast.walk(tree(file)):
        if isinstance(node, ast.Attribute):
            used.add(node.attr)
        elif isinstance(node, ast.Name):
            used.add(node.id)
        elif isinstance(node, ast.alias):
            used.add(node.name)
    return used


every_file = pytest.mark.parametrize("file", FILES, ids=module_name)


@every_file
def test_nothing_points_back_to_a_higher_layer(file: Path) -> None:
    own = module_name(file)
    if not part(own):
        assert not any(library(name) == PACKAGE for name in imports(file))
        return
    for name in imports(file):
        if library(name) == PACKAGE and part(name) and part(name) != "__version__":
            assert layer(name) <= layer(own), f"{own} imports {name}"


@every_file
def test_parts_of_one_layer_do_not_know_each_other(file: Path) -> None:
    own = module_name(file)
    if layer(own) in (0, len(ORDER)):
        return
    for name in imports(file):
        if library(name) == PACKAGE and part(name) != part(own):
            assert layer(name) != layer(own), f"{own} imports {name}"


@every_file
def test_the_product_imports_no_study(file: Path) -> None:
    if part(module_name(file)) not in {"studies", *STUDY_COMMANDS}:
        assert not any(
            part(name) == "studies" for name in imports(file) if library(name) == PACKAGE
        )


@every_file
def test_only_the_solver_imports_petsc(file: Path) -> None:
    if part(module_name(file)) != "solver":
        assert "petsc4py" not in {library(name) for name in imports(file)}


@every_file
def test_physics_knows_no_file_and_no_rank_and_output_no_rank(file: Path) -> None:
    forbidden = FORBIDDEN.get(part(module_name(file)), set())
    assert not forbidden & {library(name) for name in imports(file)}


@every_file
def test_the_world_communicator_is_named_once_and_only_commands_begin_there(file: Path) -> None:
    own = part(module_name(file))
    assert ("COMM_WORLD" in names_used(file)) == (own == "world")
    if own not in COMMANDS:
        assert f"{PACKAGE}.world" not in imports(file)


@every_file
def test_libraries_log_instead_of_printing(file: Path) -> None:
    if part(module_name(file)) not in COMMANDS:
        assert "print" not in names_used(file)


@pytest.mark.parametrize(
    "file",
    [*FILES, *sorted((ROOT / "tests").rglob("*.py"))],
    ids=lambda file: str(file.relative_to(ROOT)),
)
def test_a_file_has_one_role_and_at_most_400_lines(file: Path) -> None:
    assert len(file.read_text().splitlines()) <= MOST_LINES
    assert file.stem not in {"utils", "util", "helpers", "misc", "common"}


@pytest.mark.parametrize(
    "command", [*sorted(COMMANDS), *(f"studies.benchmarks.{name}" for name in SUBCOMMANDS)]
)
def test_starting_a_command_loads_neither_mpi_nor_petsc(command: str) -> None:
    modules = {module_name(file): file for file in FILES}
    start = f"{PACKAGE}.{command}"
    seen, todo = set(), {start, f"{start}.__main__"} & set(modules)
    while todo:
        module = todo.pop()
        seen.add(module)
        names = imports_at_start(modules[module])
        loaded = {library(name) for name in names} & PARALLEL
        assert not loaded, f"{command} loads {loaded} through {module}"
        for name in names:
            ways = {name.rsplit(".", up)[0] for up in range(name.count(".") + 1)}
            todo |= (ways & set(modules)) - seen


def test_every_module_and_folder_has_its_layer() -> None:
    parts = {part(module_name(file)) for file in FILES} - {""}
    assert parts == LAYER.keys() | COMMANDS
