"""Every command of the README and of docs/ does what it says, or says why no test runs it."""

import csv
import math
import os
import re
import shutil
import subprocess
import sys
from collections import defaultdict
from html import unescape
from pathlib import Path

import pytest

from tests.docs.pages import MODES, PAGES, READING_ORDER, ROOT, Block, blocks, rates

SECONDS = 600
RATE = re.compile(r"\d\.\d\de-\d\d")
QUICK = (
    "ensemble.meshes=1",
    "loading.extension_um=16",
    "loading.delta_k_mpa_sqrt_m=[18]",
    "output.field_steps=3",
)

# Does what ./pearlite.sh does once the environment is set up, on two ranks; the reduced form is
# added to what starts cracks, before PETSc's own options.
STAND_IN = """#!/bin/bash
set -eu
command=$1
shift
own=() petsc=()
for word in "$@"; do
    if [ "$word" = -- ] || [ ${#petsc[@]} -gt 0 ]; then petsc+=("$word"); else own+=("$word"); fi
done
case $command in
    run) exec python -m pearlite_petsc.run --ranks 2 "${own[@]}" $QUICK "${petsc[@]}" ;;
    exec)
        case "$*" in *pearlite_petsc.run*) extra=$QUICK ;; *) extra= ;; esac
        exec "${own[@]}" $extra "${petsc[@]}"
        ;;
    *) exec "$ROOT/pearlite.sh" "$command" "$@" ;;
esac
"""


def environment() -> dict[str, str]:
    paths = [str(ROOT), os.environ.get("PYTHONPATH", "")]
    return {
        **os.environ,
        "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]),
        "PYTHONPATH": os.pathsep.join(path for path in paths if path),
        "OMP_NUM_THREADS": "1",
        "OMPI_MCA_rmaps_base_oversubscribe": "1",
        "OMPI_MCA_mpi_yield_when_idle": "1",
        "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
        "MPLBACKEND": "Agg",
        "ROOT": str(ROOT),
        "QUICK": "",
    }


def checkout(folder: Path) -> Path:
    """Make a folder in which a reader could follow a page."""
    for name, pattern in (("runs", "*.*"), ("meshes", "*.toml")):
        (folder / name).mkdir()
        for file in (ROOT / name).glob(pattern):
            if file.is_file():
                shutil.copy(file, folder / name)
    (folder / "pearlite.sh").write_text(STAND_IN)
    (folder / "pearlite.sh").chmod(0o755)
    return folder


def follow(block: Block, folder: Path) -> None:
    quick = " ".join(f"--set {value}" for value in QUICK) if block.mode == "quick" else ""
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", block.script],
        cwd=folder,
        env={**environment(), "QUICK": quick},
        capture_output=True,
        text=True,
        timeout=SECONDS,
    )
    where = f"{block.page}:{block.line}\n{block.script}"
    assert done.returncode == 0, f"{where}{done.stdout[-2000:]}{done.stderr[-3000:]}"


def geometric_means(table: Path) -> list[str]:
    """Return a rates table of the documentation from the rows of ``fcg.csv``."""
    found: defaultdict[str, dict[float, list[str]]] = defaultdict(dict)
    with table.open(newline="") as stream:
        for row in csv.DictReader(stream):
            at = found[row["state"]].setdefault(float(row["delta_k_mpa_sqrt_m"]), [])
            at.append(row["da_dn_m_per_cycle"] if row["stop_reason"] == "grown" else "")
    lines = []
    for state, levels in found.items():
        cells = []
        for level in sorted(levels):
            grown = [math.log(float(rate)) for rate in levels[level] if rate]
            mean = f"{math.exp(sum(grown) / len(grown)):.2e}" if grown else "-"
            few = len(grown) < len(levels[level])
            cells.append(mean + (f" ({len(grown)} of {len(levels[level])})" if few else ""))
        lines.append(f"| {state} | {' | '.join(cells)} |")
    return lines


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_block_says_how_it_is_tested(page: Path) -> None:
    for block in [*blocks(page), *blocks(page, "python")]:
        assert block.mode in MODES, f"{block.page}:{block.line} has no <!-- test: ... --> before it"
        assert bool(block.reason) == (block.mode == "not run"), f"{block.page}:{block.line}"


def report_commands(report: Path) -> Block:
    """Return the commands that a report gives under "How this was made"."""
    listing = re.findall(r"<pre>(.*?)</pre>", report.read_text(encoding="utf-8"), re.DOTALL)
    (commands,) = [text for text in listing if "./pearlite.sh run" in text]
    return Block(report.name, 0, "quick", "", unescape(commands))


@pytest.mark.parametrize(
    "pages", [READING_ORDER[:2], pytest.param(READING_ORDER, marks=pytest.mark.slow)], ids=len
)
def test_readme_and_guides_work_in_reading_order_in_one_folder(
    pages: tuple[Path, ...], tmp_path: Path
) -> None:
    folder = checkout(tmp_path)
    for page in pages:
        follow_page(page, folder)
    follow(report_commands(folder / "runs" / "quickstart" / "report.html"), folder)


@pytest.mark.parametrize(
    "page",
    [page for page in PAGES if page not in READING_ORDER],
    ids=lambda page: str(page.relative_to(ROOT)),
)
def test_the_commands_of_a_page_work_one_after_the_other(page: Path, tmp_path: Path) -> None:
    if not any(block.mode in ("verbatim", "quick") for block in blocks(page)):
        pytest.skip("no commands")
    follow_page(page, checkout(tmp_path))


def follow_page(page: Path, folder: Path) -> None:
    """Carry out the commands of a page, then its Python as one script, on one and two ranks."""
    for block in blocks(page):
        if block.mode in ("verbatim", "quick"):
            follow(block, folder)
    python = [block.script for block in blocks(page, "python") if block.mode == "verbatim"]
    if python:
        (folder / "script.py").write_text("".join(python), encoding="utf-8")
        follow(Block(page.name, 0, "verbatim", "", "python script.py\n"), folder)
        if page == ROOT / "README.md":
            follow(Block(page.name, 0, "verbatim", "", "mpirun -n 2 python script.py\n"), folder)


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_the_long_commands_of_a_page_work(page: Path, tmp_path: Path) -> None:
    chosen = [block for block in blocks(page) if block.mode == "slow"]
    if not chosen:
        pytest.skip("no long commands")
    folder = checkout(tmp_path)
    for block in chosen:
        follow(block, folder)


def test_the_batch_script_starts_and_resumes_a_run_without_slurm(tmp_path: Path) -> None:
    folder = checkout(tmp_path)
    srun = folder / "srun"
    # As srun would: the ranks of the job, whatever the options.
    srun.write_text(
        '#!/bin/sh\nwhile [ "${1#-}" != "$1" ]; do shift; done\nexec mpirun -n 2 "$@"\n'
    )
    srun.chmod(0o755)
    settings = environment()
    settings["QUICK"] = " ".join(f"--set {value}" for value in QUICK)
    settings["PATH"] = os.pathsep.join([str(folder), settings["PATH"]])
    settings["SLURM_ARRAY_TASK_ID"] = "3"
    for time in (1, 2):
        done = subprocess.run(
            ["sh", "runs/campaign.sbatch", "runs/first_curve.toml"],
            cwd=folder,
            env=settings,
            capture_output=True,
            text=True,
            timeout=SECONDS,
        )
        assert done.returncode == 0, f"time {time}: {done.stdout[-2000:]}{done.stderr[-2000:]}"
    with (folder / "runs/first_curve_seed3/fcg.csv").open() as stream:
        assert len(list(csv.DictReader(stream))) == 2
    resolved = (folder / "runs/first_curve_seed3/scene.resolved.toml").read_text()
    assert "\nseed = 3 " in resolved


@pytest.mark.slow
@pytest.mark.parametrize(
    ("page", "scene"),
    [("README.md", "quickstart"), ("docs/tutorial.md", "first_curve")],
    ids=["quickstart", "first_curve"],
)
def test_the_rates_in_the_documentation_are_those_of_its_command(
    page: str, scene: str, tmp_path: Path
) -> None:
    folder = checkout(tmp_path)
    command = f"./pearlite.sh run runs/{scene}.toml --set output.figures=false\n"
    follow(Block(page, 0, "slow", "", command), folder)
    computed = geometric_means(folder / "runs" / scene / "fcg.csv")
    written, found = sorted(rates(ROOT / page, scene)), sorted(computed)
    assert [RATE.sub("n", row) for row in written] == [RATE.sub("n", row) for row in found]
    for left, right in zip(written, found, strict=True):
        # The last digit may be rounded otherwise by another version of a library.
        assert numbers(left) == pytest.approx(numbers(right), rel=0.01)


def numbers(row: str) -> list[float]:
    return [float(text) for text in RATE.findall(row)]
