import dataclasses
import re
import shutil
import subprocess
from html import escape
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from pearlite_petsc import report
from pearlite_petsc.config import scene_to_toml
from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.output.draw import Result
from pearlite_petsc.output.report.elements import folded, table
from pearlite_petsc.output.report.page import write_report
from pearlite_petsc.output.results import read_results, write_results
from pearlite_petsc.output.tables import write_fcg, write_growth
from pearlite_petsc.output.xdmf import FieldSeries
from tests.output import synthetic
from tests.scenes import STATES, default_scene

VOID = {"meta", "img", "br", "link"}


class Checker(HTMLParser):
    """Collects tags and refuses a page whose elements do not close in order."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.seen: list[str] = []
        self.sources: list[str] = []
        self.links: list[str] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.append(tag)
        self.sources += [value or "" for name, value in attrs if name == "src"]
        self.links += [value or "" for name, value in attrs if name == "href"]
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data


def checked(path: Path) -> Checker:
    checker = Checker()
    checker.feed(path.read_text(encoding="utf-8"))
    assert checker.open == []
    return checker


def result_folder(folder: Path, meshes: int = 2) -> Path:
    scene = default_scene(
        loading={"extension": 48.0}, ensemble={"meshes": meshes}, states=(STATES["undeformed"],)
    )
    tasks = [o for o in synthetic.outcomes(meshes=meshes) if o.state == "undeformed"]
    (folder / "fields").mkdir(parents=True)
    with FieldSeries(folder / "fields", "undeformed_m0_dk18", scene, 5) as series:
        for state in synthetic.growth_states(synthetic.voronoi_mesh(), 5):
            series.add(state)
    text = scene_to_toml(scene)
    (folder / "scene.resolved.toml").write_text(text, encoding="utf-8")
    write_results(folder / "results.h5", text, tasks, {"host": "<script>", "ranks": 2})
    write_fcg(folder / "fcg.csv", tasks, ["undeformed"])
    for task in tasks:
        write_growth(folder / "growth", task)
    return folder


def test_report_and_figures_are_rebuilt_from_the_results_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = result_folder(tmp_path / "run")
    assert report.main([str(folder), "--animate"]) == 0
    written = ("figures/film_undeformed.gif", "report.html")
    assert capsys.readouterr().out == "".join(f"wrote {folder / name}\n" for name in written)
    drawn = {path.name for path in (folder / "figures").iterdir()}
    names = ("fcg", "growth", "tortuosity", "paths", "path_undeformed", "microstructure", "mesh")
    for name in (*names, "lamella_angles", "lamella_roses"):
        assert {f"{name}.png", f"{name}.svg"} <= drawn
    assert "film_undeformed.gif" in drawn
    page = checked(folder / "report.html")
    assert page.seen.count("img") >= 9
    assert all(source.startswith("data:image/") for source in page.sources)
    # What a picture leads to lies beside the page.
    pictures = [link for link in page.links if not link.startswith("#")]
    assert len(pictures) == page.seen.count("img")
    assert all((folder / link).is_file() for link in pictures)
    # A scene of one state compares none.
    assert "1 state × 2 meshes × " in page.text
    assert "not decided here" not in page.text
    assert "this scene has one, undeformed" in page.text
    assert "<script>" in page.text
    assert "script" not in page.seen
    assert not list(folder.rglob("*.partial"))


def test_the_tables_alone_are_enough_for_the_curves(tmp_path: Path) -> None:
    folder = result_folder(tmp_path / "run")
    (folder / "results.h5").unlink()
    shutil.rmtree(folder / "fields")
    assert report.main([str(folder)]) == 0
    drawn = {path.stem for path in (folder / "figures").iterdir()}
    assert {"fcg", "growth", "tortuosity", "lamella_angles"} <= drawn
    assert "path_undeformed" not in drawn
    checked(folder / "report.html")


def test_a_folder_without_results_is_bad_input(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert report.main([str(tmp_path)]) == 2
    assert "no results here" in capsys.readouterr().err
    folder = result_folder(tmp_path / "run")
    assert report.main([str(folder), "--experiment", str(tmp_path / "none.csv")]) == 2
    assert "none.csv" in capsys.readouterr().err
    assert not (folder / "report.html").exists()


def test_results_beside_another_scene_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def refused(folder: Path) -> str:
        assert report.main([str(folder)]) == 2
        assert not (folder / "report.html").exists()
        return capsys.readouterr().err

    folder = result_folder(tmp_path / "run")
    scene = (folder / "scene.resolved.toml").read_text()
    (folder / "scene.resolved.toml").write_text(scene.replace("\nseed = 1 ", "\nseed = 2 "))
    assert "[microstructure] seed: 1, now 2): two runs wrote" in refused(folder)
    (folder / "results.h5").unlink()
    (folder / "provenance.json").write_text('{"seeds": {"microstructure": 1}}')
    assert "made with seed 1 (provenance.json), its scene has 2" in refused(folder)
    (folder / "provenance.json").unlink()
    (folder / "scene.resolved.toml").write_text(scene.replace("18.0", "19.0"))
    assert "holds a crack of undeformed at 18 MPa sqrt(m)" in refused(folder)
    (folder / "scene.resolved.toml").write_text(scene)
    assert report.main([str(folder)]) == 0


def test_measured_points_kept_with_the_results_are_drawn(tmp_path: Path) -> None:
    folder = result_folder(tmp_path / "run")
    stored = read_results(folder / "results.h5")
    points = "state,delta_k_mpa_sqrt_m,da_dn_m_per_cycle\nkept_steel,12,1e-8\n"
    write_results(folder / "results.h5", stored.scene_text, stored.outcomes, {}, points)
    shutil.move(folder, tmp_path / "moved")
    assert report.main([str(tmp_path / "moved")]) == 0
    drawn = (tmp_path / "moved" / "figures" / "fcg.svg").read_text(encoding="utf-8")
    assert "kept_steel" in drawn


def test_damaged_fields_cost_their_pictures_only(tmp_path: Path) -> None:
    folder = result_folder(tmp_path / "run")
    (folder / "fields" / "undeformed_m0_dk18_interfaces.h5").write_bytes(b"junk")
    assert report.main([str(folder)]) == 0
    drawn = {path.stem for path in (folder / "figures").iterdir()}
    assert "mesh" not in drawn
    assert "fcg" in drawn


def test_measured_points_are_drawn(tmp_path: Path) -> None:
    folder = result_folder(tmp_path / "run")
    points = tmp_path / "points.csv"
    points.write_text("state,delta_k_mpa_sqrt_m,da_dn_m_per_cycle\nmy_steel,12,1e-8\n")
    assert report.main([str(folder), "--experiment", str(points)]) == 0
    assert "my_steel" in (folder / "figures" / "fcg.svg").read_text(encoding="utf-8")


def test_the_page_tells_of_failed_tasks_rates_and_verdicts(tmp_path: Path) -> None:
    bad = Outcome("severe_AT", 9, 8e3, StopReason.FAILED, message="<i>solver</i> & co")
    tasks = [*synthetic.outcomes(), bad]
    result = Result(tmp_path, default_scene(), tasks)
    write_report(tmp_path / "report.html", result, "x = '<pre>'", {"ranks": 1})
    page = checked(tmp_path / "report.html")
    assert "severe_AT_m9_dk8: <i>solver</i> & co" in page.text
    assert "i" not in page.seen
    assert "borne out" in page.text
    rates = [o.da_dn for o in tasks if o.state == "severe_AT" and o.delta_k == 18e3]
    assert f"{np.exp(np.mean(np.log(rates))) * 1e-6:.2e}" in page.text
    assert page.seen.count("tr") > len(tasks)


def test_an_arrested_crack_has_no_rate_anywhere_on_the_page(tmp_path: Path) -> None:
    stuck = Outcome("undeformed", 0, 8e3, StopReason.ARRESTED, cycles=7.0, extension=2.0)
    good = next(o for o in synthetic.outcomes() if (o.state, o.mesh_index) == ("undeformed", 1))
    scene = default_scene(states=(STATES["undeformed"],), loading={"delta_k": (8e3,)})
    write_report(tmp_path / "report.html", Result(tmp_path, scene, [stuck, good]), "", {})
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    cells = [row.split("</td>") for row in page.split("<tr>") if ">arrested</td>" in row]
    assert len(cells) == 1
    assert cells[0][3].endswith(">–")
    assert "1 × arrested (no interface above its threshold); no growth rate" in page
    assert f"{good.da_dn / 1e6:.2e}" in page and "1 of 2" in page
    assert not re.search(r"\bnan\b", checked(tmp_path / "report.html").text)


def test_tables_escape_what_they_show() -> None:
    assert "<td>&lt;a&gt;</td>" in table(["x"], [["<a>"]], numbers_from=2)
    assert "&amp;" in folded("a & b", "")


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("chromium") is None, reason="needs Chromium")
@pytest.mark.parametrize("width", [1200, 390])
def test_a_browser_shows_the_page_without_scrolling_sideways(tmp_path: Path, width: int) -> None:
    folder = result_folder(tmp_path / "run")
    assert report.main([str(folder)]) == 0
    page = escape((folder / "report.html").read_text(encoding="utf-8"))
    shown = tmp_path / "probe.html"
    # In a frame, because a window of Chromium has at least 500 pixels.
    shown.write_text(
        f'<!DOCTYPE html><title></title><body style="margin:0"><iframe srcdoc="{page}" style="'
        f'width:{width}px;height:2000px;border:0"></iframe><script>onload = () => document.title = '
        "document.querySelector('iframe').contentDocument.documentElement.scrollWidth</script>",
        encoding="utf-8",
    )
    browser = ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run"]
    browser += ["--disable-background-networking", "--disable-component-update", "--disable-sync"]
    browser += [f"--user-data-dir={tmp_path / 'profile'}", f"--window-size={max(width, 500)},2000"]
    dom = subprocess.run(
        [*browser, "--dump-dom", shown.as_uri()], capture_output=True, text=True, check=True
    ).stdout
    found = re.search(r"<title>(\d+)</title>", dom)
    assert found is not None
    assert int(found[1]) <= width
    picture = tmp_path / "page.png"
    subprocess.run(
        [*browser, f"--screenshot={picture}", shown.as_uri()], capture_output=True, check=True
    )
    image = pytest.importorskip("PIL.Image")
    with image.open(picture) as shot:
        colours = np.unique(np.asarray(shot.convert("RGB"))[:, :width].reshape(-1, 3), axis=0)
    assert len(colours) > 500, "the pictures are not there"


def test_a_warning_free_result_says_so(tmp_path: Path) -> None:
    strong = dataclasses.replace(STATES["undeformed"], yield_stress=5000.0)
    scene = default_scene(states=(strong,), loading={"delta_k": (8e3,)})
    tasks = [o for o in synthetic.outcomes(delta_k=(8e3,)) if o.state == "undeformed"]
    write_report(tmp_path / "report.html", Result(tmp_path, scene, tasks), "", {})
    assert "every crack grew as wanted" in checked(tmp_path / "report.html").text


def test_the_time_is_that_of_all_runs_in_the_folder(tmp_path: Path) -> None:
    scene = default_scene(states=(STATES["undeformed"],))
    first = {"started": "2026-01-01T10:00:00+00:00", "ended": "2026-01-01T10:00:38+00:00"}
    second = {"started": "2026-01-01T11:00:00+00:00", "ended": "2026-01-01T11:01:22+00:00"}
    facts = {
        "command": ["pearlite", "run"],
        "source": {"commit": "abc", "changed": False},
        "ended": second["ended"],
        "wall_s": 82.0,
        "ranks": 2,
        "sessions": [first | {"ranks": 4}, second | {"ranks": 2}],
    }
    write_report(tmp_path / "report.html", Result(tmp_path, scene, []), "", facts)
    text = checked(tmp_path / "report.html").text
    assert "120 s in 2 runs on 4 and 2 rank(s)" in text
    assert f"./pearlite.sh run {tmp_path}/scene.resolved.toml --output {tmp_path}-again" in text
    assert "commit abc" in text
    # The word stands in the whole list, where it has its name.
    assert text.count("changed") == 1


def test_laws_of_ones_own_are_named_with_their_text_and_loaded_again(tmp_path: Path) -> None:
    laws = [
        {"table": "damage", "name": "film", "file": "my laws.py", "sha256": "ab" * 32},
        {"table": "material", "name": "soft", "file": "my laws.py", "sha256": "ab" * 32},
        {"table": "cycle_jump", "name": "jump", "file": "my_package.laws", "sha256": "cd" * 32},
    ]
    shipped = {"table": "damage", "name": "objective", "parameters": {}}
    scene = default_scene(states=(STATES["undeformed"],))
    facts = {"laws": [shipped, *laws]}
    write_report(tmp_path / "report.html", Result(tmp_path, scene, []), "", facts)
    text = checked(tmp_path / "report.html").text
    assert f"{tmp_path}/scene.resolved.toml --load 'my laws.py' --output" in text
    assert f'Law "film"my laws.py, SHA-256 {"ab" * 32}' in text.replace("\n", "")
    assert 'Law "objective"' not in text
