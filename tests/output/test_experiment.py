from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from pearlite_petsc.errors import SceneError
from pearlite_petsc.output.experiment import MeasuredPoint, read_experiment
from pearlite_petsc.output.literature import GROWTH_LAWS, RAIL_LIMITS, rail_limits_name

HEAD = "state,delta_k_mpa_sqrt_m,da_dn_m_per_cycle\n"


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "points.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_points_are_read_whatever_the_order_of_the_columns(tmp_path: Path) -> None:
    text = "\ufeffda_dn_m_per_cycle, state, note, delta_k_mpa_sqrt_m\n1e-9, severe_AT, x, 10\n"
    experiment = read_experiment(written(tmp_path, text))
    assert experiment.points == (MeasuredPoint("severe_AT", 10.0, 1e-9),)
    assert experiment.notes == ()


@pytest.mark.parametrize(
    ("text", "notes"),
    [
        (HEAD + "\n\na,13.5,1.5e-9\n , ,\nb,10,2e-8\n\n", 0),
        ("\n" + HEAD + "a,13.5,.15e-8\r\nb,+10,2E-08\r\n", 0),
        (HEAD.replace(",", ";") + "a;13.5;1.5e-9\nb;10;2e-8\n", 1),
        (HEAD.replace(",", ";") + "a;13,5;1,5e-9\nb;10;2e-8\n", 2),
        (HEAD.replace(",", "\t") + "a\t13,5\t1,5e-9\nb\t10\t2e-8\n", 2),
        (HEAD + '"a","13,5",1.5e-9\nb,"10",2e-8\n', 1),
    ],
)
def test_other_separators_and_decimal_commas_are_read_rightly_and_said(
    tmp_path: Path, text: str, notes: int
) -> None:
    experiment = read_experiment(written(tmp_path, text))
    assert experiment.points == (MeasuredPoint("a", 13.5, 1.5e-9), MeasuredPoint("b", 10.0, 2e-8))
    assert len(experiment.notes) == notes


def test_a_run_out_is_marked_in_a_column_of_its_own(tmp_path: Path) -> None:
    text = "state,delta_k_mpa_sqrt_m,da_dn_m_per_cycle,run_out\na,4,1e-12,yes\na,9,1e-9,\n"
    assert [p.run_out for p in read_experiment(written(tmp_path, text)).points] == [True, False]
    with pytest.raises(SceneError, match="line 2: run_out = 'maybe' must be yes or no"):
        read_experiment(written(tmp_path, text.replace("yes", "maybe")))


def test_a_state_in_other_letters_is_refused_and_one_of_its_own_is_not(tmp_path: Path) -> None:
    for state in ("Undeformed", "UNDEFORMED", "undeformed."):
        text = HEAD + f"severe_AT,13,1.5e-9\n{state},13,1.5e-9\n"
        with pytest.raises(SceneError, match="line 3: state = .* did you mean 'undeformed'"):
            read_experiment(written(tmp_path, text), ["undeformed", "severe_AT"])
    with pytest.raises(SceneError, match="did you mean 'severe_AT'"):
        read_experiment(written(tmp_path, HEAD + "severe A-T,13,1.5e-9\n"), ["severe_AT"])
    text = HEAD + "severe_TA,13,1.5e-9\n"
    assert len(read_experiment(written(tmp_path, text), ["severe_AT"]).points) == 1


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "column 'state' is missing"),
        ("state,delta_k_mpa_sqrt_m,da_dn_per_cycle\na,1,2\n", "rename column 'da_dn_per_cycle'"),
        (HEAD, "no measured points"),
        (HEAD + "a,ten,1e-9\n", "line 2: delta_k_mpa_sqrt_m = 'ten'"),
        (HEAD + "a,10,1e-9\na,-10,1e-9\n", "line 3: delta_k_mpa_sqrt_m = '-10'"),
        (HEAD + "a,10,nan\n", "da_dn_m_per_cycle = 'nan'"),
        (HEAD + "a,inf,1e-9\n", "delta_k_mpa_sqrt_m = 'inf'"),
        (HEAD + "a,10\n", "line 2: has 2 fields where the header has 3"),
        (
            HEAD + "a,13,5,1.5e-9\n",
            "line 2: has 4 fields where the header has 3; a decimal comma",
        ),
        (HEAD + "a,10,1e-9,\n", "line 2: has 4 fields"),
        (
            HEAD.replace(",", ";") + "a;10;1e-9;x\n",
            "line 2: has 4 fields where the header has 3",
        ),
        (HEAD + "a;10;1e-9\n", "line 2: has 1 fields"),
        (HEAD + "\n\na,10,1e-9\n\nb,ten,1e-9\n", "line 6: delta_k_mpa_sqrt_m = 'ten'"),
        (HEAD + HEAD + "a,10,1e-9\n", "line 2: delta_k_mpa_sqrt_m = 'delta_k_mpa_sqrt_m'"),
        ("state,state,delta_k_mpa_sqrt_m,da_dn_m_per_cycle\n", "column 'state' appears 2 times"),
        ("State,delta_k_mpa_sqrt_m,da_dn_m_per_cycle\n", "rename column 'State'"),
        (HEAD.replace(",", ";") + "a;13,500;1e-9\n", "may be 13500 or 13.500"),
        (HEAD + "a,1_0,1e-9\n", "delta_k_mpa_sqrt_m = '1_0' is not a positive number"),
        (HEAD + "a,\u0661,1e-9\n", "is not a positive number"),
        (HEAD + "a,13,5\n", "da_dn_m_per_cycle = '5' is above 0.001"),
        (HEAD + "a,2e4,1e-9\n", "delta_k_mpa_sqrt_m = '2e4' is above 10000"),
        (HEAD + 'a,10,1e-9\n"a,11,1e-9\n', "line 3: is not CSV"),
        (HEAD + '"a,10,1e-9\na",11,1e-9\n', "line 2: a quoted field runs on to line 3"),
        (HEAD + 'a,"10"1,1e-9\n', "line 2: is not CSV"),
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


def test_limits_of_another_load_ratio_say_so() -> None:
    assert rail_limits_name(0.5) == "EN 13674-1 limits (for R = 0.5)"
    assert rail_limits_name(0.1) == "EN 13674-1 limits (for R = 0.5; computed: R = 0.1)"
