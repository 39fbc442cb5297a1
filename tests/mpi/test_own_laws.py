"""Runs with laws from a file: on several ranks, resumed, from their results, and refused."""

import hashlib
import json
import sys
from pathlib import Path

import pytest

from pearlite_petsc.output.results import read_results
from tests.mpi.launch import outcomes, run

LAW = '''
"""Soft films along prior austenite grains."""

from dataclasses import replace

import numpy as np

from pearlite_petsc.fatigue.damage import objective
from pearlite_petsc.laws import DamageLaw, Limits, number
from pearlite_petsc.scene import Kind


def soft_film(interfaces, damage, *, film_strength):
    film = interfaces.kind == Kind.PRIOR_AUSTENITE_GRAIN
    strength = np.where(film, film_strength * interfaces.strength, interfaces.strength)
    return objective(replace(interfaces, strength=strength), damage)


LAWS = [
    DamageLaw(
        name="soft_film",
        help="soft films along prior austenite grains",
        function=soft_film,
        parameters=(number("film_strength", 0.5, "over the yield stress", Limits(0.01, 1.0)),),
    )
]
'''
CHOSEN = ("--set", "damage.law=soft_film", "--set", "damage.film_strength=0.25")
SHORT = ("--set", "loading.delta_k_mpa_sqrt_m=[18]", "--set", "loading.extension_um=5")
OTHER = (sys.executable, str(Path(__file__).with_name("other_file_on_rank_1.py")))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a run on two ranks with a law of its own."""
    folder = tmp_path_factory.mktemp("own_law")
    (folder / "my_law.py").write_text(LAW)
    done = run(2, folder, "--load", "my_law.py", *CHOSEN, *SHORT)
    assert done.returncode == 0, done.stderr
    return folder


def test_results_and_provenance_name_the_law_its_parameters_and_the_hash_of_its_text(
    folder: Path,
) -> None:
    expected = {
        "table": "damage",
        "key": "law",
        "name": "soft_film",
        "parameters": {"film_strength": 0.25},
        "file": "my_law.py",
        "sha256": hashlib.sha256(LAW.encode()).hexdigest(),
    }
    out = folder / "out"
    for provenance in (
        json.loads((out / "provenance.json").read_text()),
        read_results(out / "results.h5").provenance,
    ):
        assert expected in provenance["laws"]
    written = (out / "scene.resolved.toml").read_text()
    assert f'law_sha256 = "{expected["sha256"]}"' in written
    assert "film_strength = 0.25" in written


def test_going_on_needs_the_same_text(folder: Path) -> None:
    again = run(1, folder, "--load", "my_law.py", *CHOSEN, *SHORT, "--resume")
    assert again.returncode == 0, again.stderr
    other = folder / "other_law.py"
    other.write_text(LAW + "# another text\n")
    done = run(1, folder, "--load", "other_law.py", *CHOSEN, *SHORT, "--resume")
    assert done.returncode == 2
    sums = [hashlib.sha256(text.encode()).hexdigest() for text in (LAW, LAW + "# another text\n")]
    assert f"holds another scene ([damage] law_sha256: {sums[0]}, now {sums[1]})" in done.stderr
    assert done.stderr.count("\n") == 1


def test_results_are_a_scene_again_with_the_same_law_only(folder: Path) -> None:
    results = folder / "out" / "results.h5"
    (folder / "changed_law.py").write_text(LAW + "# another text\n")
    for load, status, message in (
        ((), 2, 'law = "soft_film" must be one of "objective"'),
        (("--load", "changed_law.py"), 2, 'is not the text of "soft_film"'),
        (("--load", "my_law.py"), 0, ""),
    ):
        done = run(1, folder, *load, "--set", "microstructure.seed=1", "--dry-run", scene=results)
        assert done.returncode == status, done.stderr
        assert message in done.stderr
        assert done.stderr.count("\n") == (status == 2)


def test_a_rank_that_cannot_read_the_law_is_told_once_and_nothing_is_written(
    tmp_path: Path,
) -> None:
    (tmp_path / "here.py").write_text(LAW)
    done = run(2, tmp_path, "--load", "here.py", *CHOSEN, program=OTHER)
    assert done.returncode == 2
    assert done.stderr.count("there.py: cannot be read: No such file or directory") == 1
    assert not (tmp_path / "out").exists()
    (tmp_path / "there.py").write_text(LAW + "# another text\n")
    done = run(2, tmp_path, "--load", "here.py", *CHOSEN, program=OTHER)
    assert done.returncode == 2
    assert done.stderr.count("rank 1 has read another scene or another text of a law") == 1
    assert not (tmp_path / "out").exists()


FADING = """
from dataclasses import replace

from pearlite_petsc.fatigue.damage import objective
from pearlite_petsc.laws import DamageLaw


def fading(interfaces, damage):
    found = objective(interfaces, damage)
    return replace(found, factor=found.factor / (1.0 + interfaces.crack_distance / 4.0))


LAWS = [DamageLaw(name="fading", help="for tests", function=fading, follows_crack=True)]
"""


def test_two_ranks_a_crack_follow_it_as_one_does(tmp_path: Path) -> None:
    (tmp_path / "fading.py").write_text(FADING)
    given = ("--load", "fading.py", "--set", "damage.law=fading", *SHORT, "--overwrite")
    alone = run(1, tmp_path, *given)
    assert alone.returncode == 0, alone.stderr
    one = outcomes(tmp_path)
    together = run(2, tmp_path, *given, "--ranks-per-task", 2)
    assert together.returncode == 0, together.stderr
    for mine, theirs in zip(one, outcomes(tmp_path), strict=True):
        assert mine.shape is not None and theirs.shape is not None
        assert sorted(map(tuple, mine.shape.broken_pairs)) == sorted(
            map(tuple, theirs.shape.broken_pairs)
        )
        assert theirs.da_dn == pytest.approx(mine.da_dn, rel=1e-5)
