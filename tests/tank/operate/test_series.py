import math
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import laticauda as lc
from laticauda.paper import TABLE2, load_repeats
from laticauda.paper.measured import read_path_following_trials
from laticauda.tank.operate.series import run_series
from laticauda.tank.operate.session import Result
from laticauda.tank.operate.settings import Operation, SeriesFile, load_operation
from laticauda.trials import Trial


@pytest.fixture(scope="module")
def swum() -> Trial:
    gait = lc.lateral_undulation(
        amplitude=math.radians(30), frequency=math.radians(90), phase_shift=math.radians(40)
    )
    return lc.swim(lc.load_robot("mamba"), gait, duration=2.0)


def result(name: str, trial: Trial | None, reason: str = "The run reached its end.") -> Result:
    return Result(
        name=name,
        accepted=trial is not None,
        reason=reason,
        trial=trial,
        start=(0.0, 1.0, 0.1),
        idle_current=1.18,
        supply_voltage=35.0,
        notes=(),
        recording=None,
        timing=None,
    )


def powered(trial: Trial, watts: float) -> Trial:
    return replace(trial, electrical_work=watts * trial.time)


def small(**changes) -> SeriesFile:
    series = load_operation(TABLE2)
    return replace(series, trials=series.trials[:2], repeats=2, retries=1, **changes)


def test_the_papers_table_2_is_a_series_of_its_twelve_starts():
    series = load_operation(TABLE2)
    measured = read_path_following_trials()
    assert len(series.trials) == len(measured) == 12
    for operation, row in zip(series.trials, measured, strict=True):
        assert operation.gait == row.gait
        assert operation.robot == ("mamba-fin" if row.has_fin else "mamba")
        assert operation.start is not None
        assert operation.start.position[1] == row.initial_cross_track_error
        assert operation.start.heading == pytest.approx(row.initial_heading)
        operation.body()


def test_a_series_has_mean_and_scatter_and_the_reason_of_every_rejected_run(
    tmp_path: Path, swum: Trial
):
    runs: list[str] = []

    def run(operation: Operation, folder: Path) -> Result:
        runs.append(operation.name)
        if operation.name.endswith("case-1-2"):
            return result(operation.name, None, "The run was ended: a module reports water inside.")
        return result(operation.name, powered(swum, 50.0 + len(runs)))

    done = run_series(small(), tmp_path, run)
    assert done.is_complete
    assert [name[-3:] for name in runs] == ["1-1", "1-2", "1-3", "2-1", "2-2"]
    mean, deviation = done.settings[0].figure("electrical_power") or (0, 0)
    assert (mean, deviation) == (pytest.approx(52.0), pytest.approx(math.sqrt(2)))
    total = done.settings[0].figure("total_power")
    assert total is not None and total[0] == pytest.approx(52.0 + 35 * 1.18)
    assert (
        "rejected: lateral-undulation-case-1-2: The run was ended: a module reports water"
        in done.table()
    )
    assert done.summary()["settings"][0]["rejected"] == [
        "The run was ended: a module reports water inside."
    ]


def test_its_repeats_are_what_the_report_reads(tmp_path: Path, swum: Trial):
    run_series(small(), tmp_path, lambda operation, _: result(operation.name, powered(swum, 50.0)))
    (repeat,) = load_repeats(tmp_path / "repeats.csv")
    assert repeat.gait == load_operation(TABLE2).trials[0].gait
    assert repeat.forward_velocity == (pytest.approx(swum.forward_velocity),) * 4
    assert repeat.mean_power == (pytest.approx(50.0),) * 4


def test_a_setting_that_is_rejected_too_often_is_given_up(tmp_path: Path):
    done = run_series(
        small(), tmp_path / "a", lambda o, _: result(o.name, None, "The robot lies elsewhere.")
    )
    assert not done.is_complete
    assert [len(setting.results) for setting in done.settings] == [3, 3]


@pytest.mark.parametrize("accepted", [True, False])
def test_a_key_ends_the_series_even_when_it_is_pressed_after_a_run_that_counts(
    accepted: bool, tmp_path: Path, swum: Trial
):
    stopped = partial(replace, stopped=True)
    done = run_series(
        small(), tmp_path, lambda o, _: stopped(result(o.name, swum if accepted else None))
    )
    assert [len(setting.results) for setting in done.settings] == [1]


@pytest.mark.parametrize("is_acknowledged", [True, False])
def test_after_a_fault_a_series_goes_on_only_if_somebody_has_looked_at_the_robot(
    is_acknowledged: bool, tmp_path: Path, swum: Trial
):
    faulty = partial(replace, needs_acknowledgment=True)
    asked: list[str] = []

    def acknowledge(result: Result) -> bool:
        asked.append(result.name)
        return is_acknowledged

    def run(operation: Operation, _: Path) -> Result:
        found = result(operation.name, swum)
        return faulty(found) if operation.name.endswith("case-1-1") else found

    done = run_series(small(), tmp_path, run, acknowledge=acknowledge)
    assert asked == ["lateral-undulation-case-1-1"]
    assert done.is_complete == is_acknowledged
    unasked = run_series(small(), tmp_path / "unasked", run)
    assert [len(setting.results) for setting in unasked.settings] == [1]


def test_a_series_goes_on_where_it_was_stopped(tmp_path: Path, swum: Trial):
    runs: list[str] = []

    def run(operation: Operation, folder: Path) -> Result:
        runs.append(operation.name)
        folder.mkdir(exist_ok=True, parents=True)
        swum.save(folder / f"{operation.name}.nc")
        return result(operation.name, swum)

    run_series(small(), tmp_path, run)
    again = run_series(small(), tmp_path, run)
    assert len(runs) == len(set(runs)) == 4
    assert again.is_complete


def test_somebody_is_asked_to_put_the_robot_there_before_every_run(tmp_path: Path, swum: Trial):
    asked: list[tuple[str, int]] = []
    run_series(
        small(),
        tmp_path,
        lambda o, _: result(o.name, swum),
        place=lambda operation, number: asked.append((operation.name, number)),
    )
    assert asked[:2] == [("lateral-undulation-case-1", 1), ("lateral-undulation-case-1", 2)]
    assert np.size(asked) == 8
