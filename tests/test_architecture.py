"""The layers of the package, read from its source: nothing points back, each library in its place.

Every rule holds for all of the package, without exceptions.
"""

import ast
import graphlib
import re

import pytest

from pearlite_petsc.__main__ import COMMANDS as LISTED_COMMANDS
from pearlite_petsc.bench import SUBCOMMANDS
from tests.source import (
    MODULES,
    PACKAGE,
    ROOT,
    TEST_FILES,
    bound_attributes,
    fields,
    imports,
    imports_at_start,
    library,
    lines_of_code,
    methods,
    names_used,
    own_modules,
    tree,
)

COMMANDS = {name.replace("-", "_") for name in LISTED_COMMANDS}
LAYERS: tuple[set[str], ...] = (
    {"arrays", "errors", "exit_status", "world"},
    {"laws", "launch"},
    {"scene"},
    {"microstructure"},
    {"tessellation"},
    {"mechanics"},
    {"fatigue"},
    {"config"},
    {"solver"},
    {"growth"},
    {"output"},
    {"ensemble"},
    {"face"},
    {"studies"},
    {"command_line"},
    {"run_options"},
    COMMANDS,
    {"__main__"},
)
"""From bottom to top; parts of one layer do not know each other."""

LAYER = {name: layer for layer, names in enumerate(LAYERS) for name in names}
OF_STUDIES = {"studies", "verify", "bench", "check_law"}
PHYSICS = {"config", "laws", "microstructure", "tessellation", "mechanics", "fatigue"}
PARALLEL = {"mpi4py", "petsc4py"}
WITH_STATE = {"fatigue", "solver", "growth"}
FILES_AND_FIGURES = {"h5py", "meshio", "matplotlib"}
NO_ROLE = {"utils", "util", "helpers", "misc", "common"}
MOST_LINES, MOST_LINES_OF_CODE, MOST_METHODS, MOST_ATTRIBUTES = 300, 50, 15, 12


def part(module: str) -> str:
    """Return the part of the package that a module belongs to, empty for the package itself."""
    return (module + ".").split(".")[1]


INSIDE = [module for module in MODULES if part(module)]


def test_every_module_and_folder_has_its_layer() -> None:
    assert {part(module) for module in INSIDE} == LAYER.keys()


def test_contributors_read_the_same_layers() -> None:
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    table = page.split(f"| in `{PACKAGE}/` |")[1].split("\n\n")[0].splitlines()[2:]
    assert [set(re.findall(r"`(\w+)`", row.split("|")[1])) for row in table] == [*LAYERS[::-1]]


def test_nothing_points_back_or_aside() -> None:
    wrong = [
        f"{module} imports {other}"
        for module in INSIDE
        for other in own_modules(imports(module))
        if part(other) != part(module) and LAYER[part(other)] >= LAYER[part(module)]
    ]
    assert not wrong


def test_the_package_offers_the_face_and_loads_none_of_it() -> None:
    assert not own_modules(imports_at_start(PACKAGE))
    assert {part(module) for module in own_modules(imports(PACKAGE))} == {"errors", "face"}


def test_imports_go_round_in_no_circle() -> None:
    graph = {module: own_modules(imports(module)) - {module} for module in MODULES}
    list(graphlib.TopologicalSorter(graph).static_order())


def test_the_product_imports_no_study() -> None:
    product = [module for module in MODULES if part(module) not in OF_STUDIES]
    wrong = {m: o for m in product for o in own_modules(imports(m)) if part(o) == "studies"}
    assert not wrong


def test_only_the_solver_imports_petsc() -> None:
    users = {part(m) for m in MODULES if "petsc4py" in map(library, imports(m))}
    assert users == {"solver"}


def test_physics_knows_no_file_and_no_rank_and_output_no_rank() -> None:
    forbidden = dict.fromkeys(PHYSICS, PARALLEL | FILES_AND_FIGURES) | {"output": PARALLEL}
    wrong = {
        module: found
        for module in MODULES
        if (found := forbidden.get(part(module), set()) & set(map(library, imports(module))))
    }
    assert not wrong


def test_the_world_communicator_is_named_once_and_commands_and_face_begin_there() -> None:
    assert [part(module) for module in MODULES if "COMM_WORLD" in names_used(module)] == ["world"]
    begin = {part(m) for m in MODULES if f"{PACKAGE}.world" in own_modules(imports(m))}
    assert begin <= COMMANDS | {"face"}


def test_libraries_log_instead_of_printing() -> None:
    assert not [module for module in MODULES if "print" in names_used(module)]


def test_a_file_has_one_role_and_at_most_300_lines() -> None:
    files = [*MODULES.values(), *TEST_FILES]
    assert not [file for file in files if file.stem in NO_ROLE]
    large = {
        str(file.relative_to(ROOT)): lines
        for file in files
        if (lines := len(file.read_text(encoding="utf-8").splitlines())) > MOST_LINES
    }
    assert not large


def test_a_function_has_at_most_50_lines_of_code() -> None:
    large = {
        f"{file.relative_to(ROOT)}: {node.name}": lines
        for file in [*MODULES.values(), *TEST_FILES]
        for node in ast.walk(tree(file))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        and (lines := lines_of_code(node, file)) > MOST_LINES_OF_CODE
    }
    assert not large


def attributes(module: str, owner: ast.ClassDef) -> int:
    """Return how many attributes a class has, where a run keeps its state with its fields."""
    bound = bound_attributes(owner)
    return len(bound | fields(owner) if part(module) in WITH_STATE else bound)


def test_a_class_has_at_most_15_methods_and_12_attributes() -> None:
    sizes = {
        f"{module}.{node.name}": (methods(node), attributes(module, node))
        for module, file in MODULES.items()
        for node in ast.walk(tree(file))
        if isinstance(node, ast.ClassDef)
    }
    assert not {
        name: size
        for name, size in sizes.items()
        if size[0] > MOST_METHODS or size[1] > MOST_ATTRIBUTES
    }


STARTS = [
    *(f"{PACKAGE}.{name}" for name in ("__main__", *sorted(COMMANDS))),
    *(f"{PACKAGE}.studies.benchmarks.{name}" for name in SUBCOMMANDS),
    *(module for module in MODULES if part(module) == "face"),
]


@pytest.mark.parametrize("start", STARTS)
def test_starting_a_command_or_the_face_loads_neither_mpi_nor_petsc(start: str) -> None:
    seen: set[str] = set()
    todo = {start}
    while todo:
        module = todo.pop()
        seen.add(module)
        names = imports_at_start(module)
        assert not {library(name) for name in names} & PARALLEL, f"{start} through {module}"
        todo |= own_modules(names) - seen
