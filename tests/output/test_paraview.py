"""The standard picture of ParaView, where ParaView is installed."""

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from pearlite_petsc.output.xdmf import FieldSeries
from tests.output import synthetic
from tests.scenes import default_scene

SCRIPT = Path(__file__).parents[2] / "runs" / "paraview_crack.py"
# The tests' own libraries are not those that ParaView is built with.
OUTSIDE = ("PYTHONPATH", "VIRTUAL_ENV", "LD_LIBRARY_PATH")
RED = [214, 26, 28]


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("pvpython") is None, reason="needs ParaView")
@pytest.mark.skipif(shutil.which("xvfb-run") is None, reason="needs xvfb-run")
def test_paraview_draws_the_opened_crack_without_a_screen(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    scene = default_scene(loading={"extension": 40.0})
    with FieldSeries(tmp_path / "run" / "fields", "undeformed_m0_dk18", scene, 4) as series:
        for state in synthetic.growth_states(synthetic.voronoi_mesh(), 4):
            series.add(state)
    outside = {name: value for name, value in os.environ.items() if name not in OUTSIDE}
    share = {}
    for step in ("0", "-1"):
        picture = tmp_path / f"step{step}.png"
        command = ["xvfb-run", "-a", "pvpython", str(SCRIPT), str(tmp_path / "run")]
        done = subprocess.run(
            [*command, "--step", step, "--output", str(picture)],
            capture_output=True,
            text=True,
            env=outside,
            timeout=120,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        assert done.stdout.splitlines()[-1] == f"wrote {picture}"
        with image.open(picture) as shot:
            assert shot.size == (1600, 1200)
            pixels = np.asarray(shot.convert("RGB")).astype(int)
        share[step] = (np.abs(pixels - RED).max(axis=2) < 8).mean()
    assert share["0"] == 0.0, "nothing is broken at the start"
    assert share["-1"] > 1e-4, "broken interfaces are not drawn"


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("pvpython") is None, reason="needs ParaView")
def test_the_script_says_what_it_lacks(tmp_path: Path) -> None:
    outside = {name: value for name, value in os.environ.items() if name not in OUTSIDE}
    outside.pop("DISPLAY", None)
    done = subprocess.run(
        ["pvpython", str(SCRIPT), str(tmp_path)],
        capture_output=True,
        text=True,
        env=outside,
        timeout=120,
    )
    assert done.returncode == 1
    assert done.stderr.strip().endswith(("xvfb-run -a pvpython ...", "fields in the scene"))
