"""Command: one mesh of a scene as an HDF5 file, with an XDMF file for ParaView beside it.

``pearlite mesh SCENE.toml [--state NAME] [--index I] [--output FILE.h5]``
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from pearlite_petsc.command_line import (
    CommandParser,
    add_load_option,
    add_output_option,
    add_set_option,
    complain,
)
from pearlite_petsc.config import (
    find_laws,
    load_scene,
    refuse_faulty_laws,
    scene_to_toml,
    state_named,
)
from pearlite_petsc.errors import PearliteError, SceneError
from pearlite_petsc.exit_status import ExitStatus
from pearlite_petsc.microstructure.cells import equivalent_diameters
from pearlite_petsc.output.mesh_file import write_mesh
from pearlite_petsc.output.mesh_xdmf import write_mesh_xdmf
from pearlite_petsc.output.whole_file import make_folder, unusable
from pearlite_petsc.scene import Scene, State
from pearlite_petsc.tessellation.build import Substrate, prepare, tessellate
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.quality import PERCENTILES, quality
from pearlite_petsc.tessellation.zone import initial_zone

_EXAMPLES = """examples:
  pearlite mesh meshes/severe_AT.toml --index 2
  pearlite mesh runs/quickstart.toml --state severe_AT --output severe_AT_m0.h5

ParaView opens the .xdmf beside the .h5 (reader "XDMF Reader").
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit status: 0, or 2 for bad input."""
    options = _parser().parse_args(arguments)
    try:
        scene = load_scene(options.scene, options.set, find_laws(options.load))
        refuse_faulty_laws(scene)
        state = _state(scene, options.scene, options.state)
        if options.index < 0:
            raise SceneError(f"--index {options.index} is negative")
        name = f"{state.name}_m{options.index}.h5"
        output = options.output or options.scene.with_name(name)
        if output.suffix not in (".h5", ".hdf5"):
            raise SceneError(f"--output {output}: a mesh is an HDF5 file, such as {name}")
        for path in (output, output.with_suffix(".xdmf")):
            if path.exists() and not options.overwrite:
                raise SceneError(f"{path} exists; --overwrite replaces it")
        make_folder(output.parent)
        substrate = prepare(scene, state, options.index)
        mesh = tessellate(substrate, initial_zone(scene))
        try:
            write_mesh(output, mesh, scene_to_toml(scene))
            shown = write_mesh_xdmf(output)
        except OSError as error:
            raise unusable(output, error) from None
    except PearliteError as error:
        complain(str(error))
        return ExitStatus.BAD_INPUT
    sys.stdout.write(f"{summary(scene, substrate, mesh)}\nwrote {output}\nwrote {shown}\n")
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


def _state(scene: Scene, path: Path, name: str | None) -> State:
    if name is not None:
        return state_named(scene, name)
    if len(scene.states) > 1:
        known = ", ".join(state.name for state in scene.states)
        raise SceneError(f"{path}: has {len(scene.states)} states, choose by --state: {known}")
    return scene.states[0]


def _parser() -> argparse.ArgumentParser:
    parser = CommandParser(
        "mesh",
        "Make one mesh of a scene: microstructure, elements, interfaces.",
        _EXAMPLES,
    )
    parser.add_argument("scene", type=Path, help="scene (TOML)")
    parser.add_argument("--state", metavar="NAME", help="state; not needed if there is only one")
    parser.add_argument(
        "--index", type=int, default=0, metavar="I", help="number of the mesh, from 0; default 0"
    )
    add_output_option(
        parser,
        "HDF5 file to write; default <state>_m<index>.h5 beside the scene",
        metavar="FILE.h5",
    )
    add_set_option(parser)
    add_load_option(parser)
    parser.add_argument("--overwrite", action="store_true", help="replace existing files")
    return parser


if __name__ == "__main__":
    sys.exit(main())
