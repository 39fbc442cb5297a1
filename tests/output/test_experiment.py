from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from pearlite_petsc.errors import SceneError
from pearlite_petsc.output.experiment import MeasuredPoint, read_experiment
from pearlite_petsc.output.literature import GROWTH_LAWS, RAIL_LIMITS

HEAD = "state,delta_k_mpa_sqrt_m,da_dn_m_per_cycle\n"


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "points.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_points_are_read_whatever_the_order_of_the_columns(tmp_path: Path) -> None:
    text = "\ufeffda_dn_m_per_cycle, state, note, delta_k_mpa_sqrt_m\n1e-9, severe_AT, x, 10\n"
    assert read_experiment(written(tmp_path, text)) == [MeasuredPoint("severe_AT", 10.0, 1e-9)]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "column 'state' is missing"),
        ("state,delta_k_mpa_sqrt_m,da_dn_per_cycle\na,1,2\n", "is 'da_dn_per_cycle' meant"),
        (HEAD, "no measured points"),
        (HEAD + "a,ten,1e-9\n", "line 2: delta_k_mpa_sqrt_m = 'ten'"),
        (HEAD + "a,10,1e-9\na,-10,1e-9\n", "line 3: delta_k_mpa_sqrt_m = '-10'"),
        (HEAD + "a,10,nan\n", "da_dn_m_per_cycle = 'nan'"),
        (HEAD + "a,inf,1e-9\n", "delta_k_mpa_sqrt_m = 'inf'"),
        (HEAD + "a,10\n", "da_dn_m_per_cycle = ''"),
        (HEAD + ",10,1e-9\n", "state is empty"),
    ],
)
def test_a_wrong_point_is_refused_with_its_line(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(SceneError, match=r"points\.csv") as error:
        read_experiment(written(tmp_path, text))
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_a_missing_or_binary_file_is_refused(tmp_path: Path) -> None:
    binary = tmp_path / "binary.csv"
    binary.write_bytes(bytes(range(256)))
    for path in (tmp_path / "nothing.csv", binary, tmp_path):
        with pytest.raises(SceneError, match="cannot be read"):
            read_experiment(path)


def test_literature_lines_are_the_published_ones() -> None:
    barsom, bs7910 = (law.rate(np.array([10.0]))[0] for law in GROWTH_LAWS)
    assert_allclose([barsom, bs7910], [6.9e-9, 1.65e-8])
    assert [(limit.delta_k, limit.rate) for limit in RAIL_LIMITS] == [
        (10.0, 1.7e-8),
        (13.5, 5.5e-8),
    ]
