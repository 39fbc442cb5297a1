"""Command: one mesh of a scene as an HDF5 file.

``pearlite mesh SCENE.toml --state NAME --index I --output FILE.h5``
"""

import argparse
import difflib
import sys
from collections.abc import Sequence
from pathlib import Path

from pearlite_petsc.command_line import (
    CommandParser,
    add_output_option,
    add_set_option,
    complain,
)
from pearlite_petsc.config import load_scene, scene_to_toml
from pearlite_petsc.errors import PearliteError, SceneError
from pearlite_petsc.exit_status import ExitStatus
from pearlite_petsc.microstructure.cells import equivalent_diameters
from pearlite_petsc.output.mesh_file import write_mesh
from pearlite_petsc.scene import Scene, State
from pearlite_petsc.tessellation.build import Substrate, prepare, tessellate
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.quality import PERCENTILES, quality
from pearlite_petsc.tessellation.zone import initial_zone


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit status: 0, or 2 for bad input."""
    options = _parser().parse_args(arguments)
    try:
        scene = load_scene(options.scene, options.set)
        state = _state(scene, options.scene, options.state)
        if options.index < 0:
            raise SceneError(f"--index {options.index} is negative")
        if options.output.exists() and not options.overwrite:
            raise SceneError(f"{options.output} exists; --overwrite replaces it")
        substrate = prepare(scene, state, options.index)
        mesh = tessellate(substrate, initial_zone(scene))
        write_mesh(options.output, mesh, scene_to_toml(scene))
    except (PearliteError, OSError) as error:
        complain(str(error))
        return ExitStatus.BAD_INPUT
    sys.stdout.write(f"{summary(scene, substrate, mesh)}\nwrote {options.output}\n")
    return ExitStatus.DONE


def summary(scene: Scene, substrate: Substrate, mesh: Mesh) -> str:
    """Return what a user checks a mesh by: sizes against their targets, elements, interfaces."""
    sizes = scene.microstructure
    targets = {
        "prior austenite grain": sizes.prior_austenite_grain,
        "block": sizes.block,
        "colony": sizes.colony,
    }
    lines = [
        f"state {mesh.state}, mesh {mesh.index}, seed {mesh.seed}",
        "mean equivalent circle diameter before shear [um]   measured  target  cells",
    ]
    diameters = equivalent_diameters(substrate.label_map)
    for (name, target), values in zip(targets.items(), diameters, strict=True):
        mean = f"{values.mean():8.2f}" if len(values) else "       -"
        lines.append(f"  {name:<49} {mean} {target:7.2f} {len(values):6d}")
    q = quality(mesh, scene.window.notch)
    lengths = ", ".join(
        f"{p:g} %: {value:.3g}" for p, value in zip(PERCENTILES, q.length_percentiles, strict=True)
    )
    kinds = ", ".join(
        f"{kind.name.lower()} {100.0 * share:.1f} %" for kind, share in q.kind_share.items()
    )
    lines += [
        f"elements {q.elements}, of which fine {q.fine_elements} with a mean equivalent circle "
        f"diameter of {q.equivalent_diameter:.3g} um and an area spread of {q.area_spread:.2f}",
        f"interfaces {q.interfaces}: {kinds}",
        f"percentiles of the lengths of fine interfaces [um]: {lengths}; dropped facets {q.dropped}",
        f"notch tip at {mesh.notch[0]:.4g} um, {q.notch_error:+.2g} um from nominal",
    ]
    return "\n".join(lines)


def _state(scene: Scene, path: Path, name: str) -> State:
    known = {state.name: state for state in scene.states}
    if name not in known:
        close = difflib.get_close_matches(name, known, n=1)
        hint = f"did you mean {close[0]}?" if close else f"known: {', '.join(known)}"
        raise SceneError(f"{path}: state {name} is unknown, {hint}")
    return known[name]


def _parser() -> argparse.ArgumentParser:
    parser = CommandParser(
        "mesh",
        "Make one mesh of a scene: microstructure, elements, interfaces.",
        "example: pearlite mesh runs/quickstart.toml --state severe_AT --index 0 "
        "--output meshes/severe_AT_m0.h5",
    )
    parser.add_argument("scene", type=Path, help="scene (TOML)")
    parser.add_argument("--state", required=True, help="name of a state of the scene")
    parser.add_argument("--index", required=True, type=int, help="number of the mesh, from 0")
    add_output_option(parser, "HDF5 file to write", metavar="FILE.h5")
    add_set_option(parser)
    parser.add_argument("--overwrite", action="store_true", help="replace an existing file")
    return parser


if __name__ == "__main__":
    sys.exit(main())
