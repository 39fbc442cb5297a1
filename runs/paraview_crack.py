"""Standard picture of a crack in ParaView, from the XDMF files of a result folder.

    pvpython runs/paraview_crack.py runs/quickstart
    pvpython runs/paraview_crack.py runs/quickstart --task severe_AT_m0_dk18 --magnify 5
    pvpython runs/paraview_crack.py runs/quickstart --task severe_AT_m0_dk18 --step 3

Elements are moved by ``displacement_um`` times the magnification, so that the crack opens, and
coloured by the mean damage of their interfaces; broken interfaces are drawn on top in red, the
notch in black, both where they were before loading. Without a screen, Debian's ``pvpython`` needs
``xvfb-run -a pvpython …``; a build with EGL or OSMesa, ``--force-offscreen-rendering``.
"""

import argparse
import os
import sys
from pathlib import Path

import paraview.simple as pv
from vtkmodules.vtkRenderingCore import vtkRenderWindow

NOTCH = 5
"""Kind of the notch's interfaces."""


def main() -> None:
    """Read the arguments, draw, and write the picture."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("result", type=Path, help="result folder (holds fields/)")
    parser.add_argument("--task", help="<state>_m<index>_dk<value>; default: the first")
    parser.add_argument("--step", type=int, default=-1, help="step of the series; default: last")
    parser.add_argument("--magnify", type=float, default=3.0, help="factor on the displacement")
    parser.add_argument("--margin", type=float, default=15.0, help="round the crack [um]")
    parser.add_argument("--output", type=Path, help="PNG; default: beside the result's figures")
    chosen = parser.parse_args()
    refuse_without_screen()
    task = chosen.task or first_task(chosen.result / "fields")
    output = chosen.output or chosen.result / "figures" / f"paraview_{task}.png"
    output.parent.mkdir(parents=True, exist_ok=True)
    draw(chosen.result / "fields", task, chosen.step, chosen.magnify, chosen.margin, output)
    sys.stdout.write(f"wrote {output}\n")


def refuse_without_screen() -> None:
    """End with a message where ParaView would crash: a build for X without a display."""
    if "DISPLAY" not in os.environ and "XOpenGL" in vtkRenderWindow().GetClassName():
        sys.exit("this build of ParaView needs a screen: xvfb-run -a pvpython ...")


def first_task(fields: Path) -> str:
    """Return the first task in alphabetical order whose fields were written."""
    found = sorted(path.name for path in fields.glob("*_elements.xdmf"))
    if not found:
        sys.exit(f"{fields}: no *_elements.xdmf here; see [output] fields in the scene")
    return found[0].removesuffix("_elements.xdmf")


def draw(fields: Path, task: str, step: int, magnify: float, margin: float, output: Path) -> None:
    """Set up the pipeline, look at the crack, write the picture."""
    paths = [fields / f"{task}_{what}.xdmf" for what in ("elements", "interfaces")]
    for path in paths:
        if not path.is_file():
            sys.exit(f"{path}: not found")
    elements, interfaces = (pv.XDMFReader(FileNames=[str(path)]) for path in paths)
    times = list(elements.TimestepValues)
    if not -len(times) <= step < len(times):
        sys.exit(f"--step {step}: the series has {len(times)} steps")
    view = pv.CreateRenderView(ViewSize=[1600, 1200])
    view.UseColorPaletteForBackground = 0
    view.Background = [1.0, 1.0, 1.0]
    view.OrientationAxesVisibility = 0
    view.ViewTime = times[step]

    warped = pv.WarpByVector(Input=elements, Vectors=["POINTS", "displacement_um"])
    warped.ScaleFactor = magnify
    shown = pv.Show(warped, view)
    shown.Ambient, shown.Diffuse = 1.0, 0.0
    pv.ColorBy(shown, ("CELLS", "mean_damage"))
    colours = pv.GetColorTransferFunction("mean_damage")
    colours.RGBPoints = [
        *(0.0, 0.90, 0.90, 0.87),
        *(0.4, 0.99, 0.75, 0.37),
        *(1.0, 0.60, 0.0, 0.05),
    ]
    bar = pv.GetScalarBar(colours, view)
    bar.Title, bar.ComponentTitle = "mean damage", ""
    bar.TitleColor = bar.LabelColor = [0.0, 0.0, 0.0]
    bar.AddRangeLabels, bar.AutomaticLabelFormat, bar.LabelFormat = 0, 0, "%.1f"
    bar.TitleFontSize = bar.LabelFontSize = 22
    bar.ScalarBarLength, bar.Position = 0.35, [0.9, 0.05]
    bar.WindowLocation = "Any Location"
    shown.SetScalarBarVisibility(view, True)

    broken = chosen_lines(interfaces, "broken", 1)
    notch = chosen_lines(interfaces, "kind", NOTCH)
    for lines, colour, width in ((broken, [0.84, 0.1, 0.11], 4.0), (notch, [0.0, 0.0, 0.0], 6.0)):
        lines.UpdatePipeline(times[step])
        if lines.GetDataInformation().GetNumberOfCells() == 0:
            # Nothing is broken at the start, and what is empty cannot be coloured.
            continue
        display = pv.Show(lines, view)
        pv.ColorBy(display, None)
        display.AmbientColor = display.DiffuseColor = colour
        display.LineWidth = width
        display.Position = [0.0, 0.0, 0.5]

    text = pv.Text(Text=f"{task}   N = {times[step]:.4g} cycles, displacement x {magnify:g}")
    label = pv.Show(text, view)
    label.Color, label.FontSize, label.WindowLocation = [0.0, 0.0, 0.0], 24, "Upper Left Corner"

    # The first rendering moves the camera to show everything.
    pv.Render(view)
    look_at_crack(view, broken, elements, times[step], margin)
    pv.SaveScreenshot(str(output), view)


def chosen_lines(interfaces: object, field: str, value: int) -> object:
    """Return the interfaces whose field has one whole value."""
    lines = pv.Threshold(Input=interfaces, Scalars=["CELLS", field])
    lines.LowerThreshold, lines.UpperThreshold = value - 0.5, value + 0.5
    return lines


def look_at_crack(
    view: object, broken: object, elements: object, time: float, margin: float
) -> None:
    """Point the camera at the broken interfaces, or at everything while there are none."""
    for source in (broken, elements):
        source.UpdatePipeline(time)
        left, right, bottom, top, _, _ = pv.servermanager.Fetch(source).GetBounds()
        if left <= right:
            break
    x, y = 0.5 * (left + right), 0.5 * (bottom + top)
    wide, high = view.ViewSize
    half = max(0.5 * (top - bottom), 0.5 * (right - left) * high / wide) + margin
    view.CameraParallelProjection = 1
    view.CameraPosition, view.CameraFocalPoint = [x, y, 1000.0], [x, y, 0.0]
    view.CameraViewUp = [0.0, 1.0, 0.0]
    view.CameraParallelScale = half


if __name__ == "__main__":
    main()
