"""Scenes in the names and units of their files."""

import tomllib
from collections.abc import Iterable, Iterator, Mapping
from os import PathLike
from types import MappingProxyType
from typing import Any, TypeAlias

from pearlite_petsc import config
from pearlite_petsc.config.shipped import SHIPPED
from pearlite_petsc.laws.catalogue import Laws
from pearlite_petsc.scene import Scene as ProgramScene

Files: TypeAlias = str | PathLike[str] | Iterable[str | PathLike[str]]


class Scene(Mapping[str, Any]):
    """A description of what to compute, in the names and units of a scene file (TOML); immutable.

    Keys that are left out take the quickstart's values. A scene reads like its file:
    ``scene["loading"]["load_ratio"]``.

    Args:
        name: Name of the scene and of its output folder; "scene" if left out.
        load: A Python file, or several, with laws of your own that the scene may choose.
        tables: Tables of the file by name, each a mapping: ``loading={"load_ratio": 0.5}``.

    Raises:
        PearliteError: A table, key or value cannot be used; the message names it, its limits and
            the nearest known name.

    Examples:
        >>> scene = Scene(loading={"delta_k_mpa_sqrt_m": [12.0, 18.0]}, ensemble={"meshes": 2})
        >>> scene
        <Scene scene: 5 states x 2 meshes x 2 Delta-K = 20 cracks, window 200 x 200 um>
        >>> scene["loading"]["load_ratio"]
        0.1
        >>> scene.states["severe_AT"]["yield_stress_mpa"]
        1024.0
    """

    __slots__ = ("_laws", "_program", "_tables")

    def __init__(self, name: str = "scene", *, load: Files = (), **tables: Any) -> None:
        laws = found_laws(load)
        self._set(_checked({"name": name, **tables}, laws), laws)

    @classmethod
    def from_dict(cls, tables: Mapping[str, Any], *, load: Files = ()) -> "Scene":
        """Return the scene given by nested tables, such as ``tomllib.load`` returns.

        Args:
            tables: Tables of the file by name.
            load: As for the class.

        Raises:
            PearliteError: As for the class.

        Examples:
            >>> Scene.from_dict({"states": {"undeformed": {}}}).states.keys()
            dict_keys(['undeformed'])
        """
        laws = found_laws(load)
        return cls._of(_checked(tables, laws), laws)

    @classmethod
    def _of(cls, program: ProgramScene, laws: Laws = SHIPPED) -> "Scene":
        scene = cls.__new__(cls)
        scene._set(program, laws)
        return scene

    def _set(self, program: ProgramScene, laws: Laws) -> None:
        self._program, self._laws = program, laws
        self._tables = _frozen(tomllib.loads(config.scene_to_toml(program)))

    @property
    def name(self) -> str:
        """Name of the scene and of its output folder."""
        return self._program.name

    @property
    def states(self) -> Mapping[str, Mapping[str, Any]]:
        """Table of each state, by the state's name; iterating gives the names."""
        states: Mapping[str, Mapping[str, Any]] = self._tables["states"]
        return states

    def replace(self, **changes: Any) -> "Scene":
        """Return a copy of the scene with some keys changed.

        Args:
            changes: Tables by name, with the keys to change; ``name="other"`` changes the name.
                ``states`` may also be a list of names, which keeps only those states.

        Raises:
            PearliteError: As for the class.

        Examples:
            >>> base = Scene()
            >>> seeds = [base.replace(microstructure={"seed": seed}) for seed in (1, 2)]
            >>> base.replace(states=["severe_AT"], loading={"load_ratio": 0.5}).states.keys()
            dict_keys(['severe_AT'])
        """
        tables = self.to_dict()
        for name, change in changes.items():
            if name == "states" and isinstance(change, list | tuple):
                kept = [config.state_named(self._program, one).name for one in change]
                tables["states"] = {one: tables["states"][one] for one in kept}
            else:
                tables[name] = _merged(tables.get(name), change)
        return self._of(_checked(tables, self._laws), self._laws)

    def to_dict(self) -> dict[str, Any]:
        """Return all tables as plain dictionaries; ``Scene.from_dict`` takes them back."""
        return tomllib.loads(self.to_toml())

    def to_toml(self) -> str:
        """Return the text of a scene file that holds every key; ``load_scene`` reads it back."""
        return config.scene_to_toml(self._program)

    def __getitem__(self, table: str) -> Any:
        return self._tables[table]

    def __iter__(self) -> Iterator[str]:
        return iter(self._tables)

    def __len__(self) -> int:
        return len(self._tables)

    def __eq__(self, other: object) -> bool:
        return self._program == other._program if isinstance(other, Scene) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._program)

    def __repr__(self) -> str:
        scene = self._program
        counts = len(scene.states), scene.ensemble.meshes, len(scene.loading.delta_k)
        nouns = ("state", "states"), ("mesh", "meshes"), ("Delta-K", "Delta-K")
        factors = " x ".join(
            f"{count} {noun[count != 1]}" for count, noun in zip(counts, nouns, strict=True)
        )
        total = counts[0] * counts[1] * counts[2]
        size = f"{scene.window.width:g} x {scene.window.height:g} um"
        cracks = f"{total:,} crack{'' if total == 1 else 's'}"
        return f"<Scene {scene.name}: {factors} = {cracks}, window {size}>"


def load_scene(path: str | PathLike[str], *, load: Files = ()) -> Scene:
    """Read a scene file (TOML).

    Args:
        path: The file.
        load: A Python file, or several, with laws of your own that the scene may choose.

    Raises:
        PearliteError: Something in the file cannot be used; the message is one line that names
            file, table, key and limit.
    """
    laws = found_laws(load)
    program = config.load_scene(path, (), laws)
    config.refuse_faulty_laws(program)
    return Scene._of(program, laws)


def _checked(tables: Mapping[str, Any], laws: Laws) -> ProgramScene:
    program = config.scene_from_tables(tables, "Scene", laws)
    config.refuse_faulty_laws(program)
    return program


def found_laws(load: Files) -> Laws:
    """Return all laws that a scene may choose from."""
    return config.find_laws((load,) if isinstance(load, str | PathLike) else load)


def _merged(old: Any, change: Any) -> Any:
    if isinstance(old, dict) and isinstance(change, Mapping):
        return old | {key: _merged(old.get(key), value) for key, value in change.items()}
    return change


def _frozen(value: Any) -> Any:
    if isinstance(value, dict):
        return MappingProxyType({key: _frozen(item) for key, item in value.items()})
    return tuple(value) if isinstance(value, list) else value
