"""Columns with names: read-only, by attribute and key, rows, pandas' dictionaries."""

import copy
import pickle

import numpy as np
import pytest

import pearlite_petsc as pp

TABLE = pp.Table({"state": ["a", "b"], "crack_length_um": [80.0, 81.5]})


def test_columns_are_read_by_attribute_and_by_key() -> None:
    assert TABLE.columns == ("state", "crack_length_um")
    assert np.array_equal(TABLE.crack_length_um, TABLE["crack_length_um"])
    assert {"state", "crack_length_um", "to_dict"} <= set(dir(TABLE))


def test_columns_cannot_be_changed_and_do_not_follow_what_they_were_made_from() -> None:
    values = np.array([1.0, 2.0])
    table = pp.Table({"cycles": values})
    values[0] = 9.0
    assert table.cycles.tolist() == [1.0, 2.0]
    with pytest.raises(ValueError, match="read-only"):
        table.cycles[0] = 3.0
    with pytest.raises(AttributeError):
        table.cycles = values


def test_an_unknown_column_names_the_nearest() -> None:
    with pytest.raises(AttributeError, match="no column crack_length, did you mean crack_length_"):
        _ = TABLE.crack_length
    with pytest.raises(KeyError, match="no column da_dn, known are state, crack_length_um"):
        TABLE["da_dn"]


def test_rows_are_dictionaries_of_plain_values() -> None:
    assert list(TABLE) == [
        {"state": "a", "crack_length_um": 80.0},
        {"state": "b", "crack_length_um": 81.5},
    ]
    assert len(TABLE) == 2
    assert len(pp.Table({})) == 0


def test_columns_of_different_lengths_are_refused() -> None:
    with pytest.raises(ValueError, match="one length"):
        pp.Table({"a": [1.0], "b": [1.0, 2.0]})
    with pytest.raises(ValueError, match="one axis"):
        pp.Table({"a": [[1.0]]})


def test_a_table_is_copied_and_pickled() -> None:
    for other in (copy.deepcopy(TABLE), pickle.loads(pickle.dumps(TABLE))):
        assert repr(other) == repr(TABLE)
        assert other.crack_length_um.tolist() == TABLE.crack_length_um.tolist()


def test_pandas_takes_the_dictionary() -> None:
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(TABLE.to_dict())
    assert frame.columns.tolist() == ["state", "crack_length_um"]
    assert frame.crack_length_um.max() == 81.5


def test_a_notebook_shows_the_first_rows() -> None:
    html = TABLE._repr_html_()
    assert html.startswith("<table><tr><th>state</th><th>crack_length_um</th></tr>")
    assert "<tr><td>b</td><td>81.5</td></tr>" in html
    long = pp.Table({"cycles": np.arange(1e3) / 3.0, "state": ["<a>"] * 1000})
    assert long._repr_html_().count("<tr>") == 21
    assert "<td>0.333333</td><td>&lt;a&gt;</td>" in long._repr_html_()
    assert long._repr_html_().endswith("<p>and 980 more rows</p>")
