import csv
import json
from pathlib import Path

import pytest

from laticauda import load_trial


@pytest.fixture
def stored(run) -> list[str]:
    for name, options in {"bare.nc": "", "fin.nc": "--robot mamba-fin", "servo.nc": "--joints servo"}.items():
        assert run(f"swim {options} --duration 20 --save {name}").status == 0
    return ["bare.nc", "fin.nc", "servo.nc"]


def test_a_stored_trial_is_shown_as_it_was_when_it_swam(run, stored):
    swam = run("swim --duration 20").out
    shown = run("trial show bare.nc").out
    table = swam[swam.index("simulated") :]
    assert shown.endswith(table)
    assert shown.startswith(f"made     {load_trial('bare.nc').created}")


def test_a_stored_trial_can_be_read_by_a_program(run, stored):
    swam, shown = (json.loads(run(line).out) for line in ("swim --duration 20 --json", "trial show bare.nc --json"))
    assert shown == swam


def test_trials_are_compared_with_the_first(run, stored):
    text = run("trial compare bare.nc fin.nc bare.nc").out
    header, *rows = text.splitlines()
    assert header.split() == ["bare.nc", "fin.nc", "difference", "bare.nc", "difference"]
    (row,) = [row for row in rows if row.startswith("forward velocity")]
    assert row.endswith("+0.0 %")


def test_a_comparison_can_be_read_by_a_program(run, stored):
    found = json.loads(run("trial compare bare.nc fin.nc --json").out)
    assert found["trials"] == ["bare.nc", "fin.nc"]
    speed = found["figures"]["forward_velocity"]
    values = [load_trial(name).forward_velocity for name in found["trials"]]
    assert speed["unit"] == "m/s"
    assert speed["values"] == values
    assert speed["differences_percent"] == pytest.approx([0.0, 100.0 * (values[1] / values[0] - 1.0)])


def test_mechanical_and_electrical_power_are_not_compared(run, stored):
    assert "mean_power" not in json.loads(run("trial compare bare.nc servo.nc --json").out)["figures"]


def test_a_trial_is_converted_to_a_table_of_numbers(run, stored, folder: Path):
    done = run("trial convert bare.nc bare.csv")
    assert done.out == "bare.csv: 401 samples\n"
    header, *rows = list(csv.reader((folder / "bare.csv").read_text().splitlines()))
    assert header[0] == "time [s]"
    assert len(rows) == 401
    assert json.loads(run("trial convert bare.nc bare.csv --json").out) == {"output": "bare.csv", "n_samples": 401}
