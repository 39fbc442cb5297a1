import csv
from pathlib import Path

import numpy as np
import pytest

from pearlite_petsc.evaluate import main
from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.output.tables import read_fcg, write_da_dn, write_fcg, write_growth

HISTORY = np.array(
    [
        [0.0, 80.0, 0.0, 0],
        [10.0, 82.0, 2.0, 1],
        [15.0, 82.0, 2.0, 2],
        [40.0, 83.0, 3.1, 3],
        [55.0, 86.0, 6.0, 4],
        [55.0, 86.5, 6.5, 5],
        [90.0, 88.0, 8.0, 6],
        [95.0, 88.0, 8.0, 7],
        [120.0, 90.0, 10.0, 8],
        [140.0, 92.0, 12.0, 9],
    ]
)


def write(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as stream:
        return list(csv.DictReader(stream))


def outcome(first_columns: np.ndarray) -> Outcome:
    history = np.hstack([first_columns, np.full((len(first_columns), 3), np.nan)])
    grown = np.concatenate([[True], np.diff(history[:, 1]) > 0.0])
    rate = float(np.polyfit(*history[grown, :2].T, 1)[0])
    return Outcome(
        "severe_AT", 2, 18e3, StopReason.GROWN, da_dn=rate, history=history, cycles=140.0
    )


def test_the_program_s_own_file_gives_the_program_s_own_rate(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    crack = outcome(HISTORY)
    growth = write_growth(tmp_path, crack)
    assert growth is not None
    write_fcg(tmp_path / "fcg.csv", [crack], ["severe_AT"])
    assert main([str(growth)]) == 0
    printed = capsys.readouterr().out
    (line,) = [line for line in printed.splitlines() if "least squares" in line]
    wanted = read_fcg(tmp_path / "fcg.csv")[0].da_dn / 1e6
    assert float(line.split(": ")[1].split()[0]) == pytest.approx(wanted, rel=1e-5)
    assert "points: 8; rows without growth passed over: 2" in printed
    assert "growth: 12 um in 140 cycles" in printed


def test_point_by_point_the_command_gives_what_the_run_wrote(tmp_path: Path) -> None:
    crack = outcome(HISTORY)
    growth = write_growth(tmp_path, crack)
    write_da_dn(tmp_path / "da_dn.csv", [crack], ["severe_AT"])
    assert main([str(growth), "--output", str(tmp_path / "mine.csv")]) == 0
    mine, run = rows(tmp_path / "mine.csv"), rows(tmp_path / "da_dn.csv")
    assert len(mine) == len(run) == 8
    for name in ("crack_length_um", "secant_m_per_cycle", "polynomial_m_per_cycle"):
        assert [row[name] for row in mine] == [row[name] for row in run]
    assert {row["state"] for row in run} == {"severe_AT"}
    assert [row["delta_k_mpa_sqrt_m"] for row in run] == ["18.0"] * 8
    assert float(run[1]["secant_m_per_cycle"]) == pytest.approx(0.2e-6, rel=1e-12)
    assert run[0]["secant_m_per_cycle"] == run[4]["secant_m_per_cycle"] == "nan"


@pytest.mark.parametrize("unit", ["mm", "um"])
def test_slope_and_rates_of_a_measured_crack_are_found(
    unit: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    length = np.linspace(2.0, 3.0, 31)
    fine = np.linspace(2.0, 3.0, 15001)
    slowness = 1.0 / (5e-9 * (4.0 * np.sqrt(fine)) ** 3)
    steps = 0.5 * (slowness[1:] + slowness[:-1]) * np.diff(fine)
    cycles = np.concatenate([[0.0], np.cumsum(steps)])[::500]
    scale = {"mm": 1.0, "um": 1e3}[unit]
    lines = [f"cycles,crack_length_{unit},delta_k_mpa_sqrt_m"]
    lines += [
        f"{n:.6f},{scale * a:.9f},{4.0 * a**0.5:.9f}" for n, a in zip(cycles, length, strict=True)
    ]
    assert main([str(write(tmp_path / "a_N.csv", "\n".join(lines)))]) == 0
    printed = capsys.readouterr().out
    (line,) = [line for line in printed.splitlines() if line.startswith("slope of log")]
    assert float(line.split(": ")[1].split()[0]) == pytest.approx(3.0, abs=0.01)
    assert "threshold at 1e-10 m/cycle (ASTM E647): the rates do not reach it" in printed
    table = rows(tmp_path / "a_N_da_dn.csv")
    for row, a in zip(table[3:-3], length[3:-3], strict=True):
        assert float(row["polynomial_m_per_cycle"]) == pytest.approx(
            5e-12 * (4.0 * a**0.5) ** 3, rel=1e-3
        )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("cycles,length\n0,1\n", "column 'crack_length_um' is missing"),
        ("cycles,crack_length_um\n0,80\n5,79\n", "the crack got longer at none of its 2 rows"),
        ("cycles,crack_length_um\n0,80\n9,81\n5,82\n", "line 4: cycles = 5 after 9"),
        ("cycles,crack_length_um\n0,80\n5,x\n", "line 3: crack_length_um = 'x' is not a positive"),
        ("cycles,crack_length_um\n0,80,5\n", "line 2: has 3 fields where the header has 2"),
        ("cycles,crack_length_um,crack_length_mm\n0,80,.08\n", "both given, only one is needed"),
        ("cycles,crack_length_mm\n0,80000\n", "is above 10000; the column's name says its unit"),
    ],
)
def test_what_cannot_be_evaluated_is_refused_and_nothing_written(
    text: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = write(tmp_path / "a_N.csv", text)
    assert main([str(file)]) == 2
    captured = capsys.readouterr()
    assert message in captured.err and captured.err.count("\n") == 1 and not captured.out
    assert [path.name for path in tmp_path.iterdir()] == ["a_N.csv"]


def test_an_existing_file_is_replaced_only_when_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = write(tmp_path / "a_N.csv", "cycles,crack_length_um\n0,80\n5,81\n")
    assert main([str(file)]) == 0
    assert main([str(file)]) == 2
    assert "--overwrite replaces it" in capsys.readouterr().err
    assert main([str(file), "--overwrite"]) == 0


def test_semicolons_and_decimal_commas_are_read_and_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = write(tmp_path / "a_N.csv", "cycles;crack_length_um\n0;80,5\n5;81,5\n")
    assert main([str(file)]) == 0
    printed = capsys.readouterr().out
    assert "read with semicolons" in printed and "decimal commas in 2 line(s)" in printed
    assert "growth over cycles: 2e-07 m/cycle" in printed
