import csv
from dataclasses import replace
from math import radians
from pathlib import Path

import numpy as np
import pytest
import xarray

import laticauda as lc
from laticauda.studies import Front, Optimization, optimization as module, pareto_front
from laticauda.studies.point_trials import QUANTITIES

SOUGHT = Optimization(
    scenario=lc.build_scenario(
        "mamba-fin", lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7)
    ),
    bounds={
        "gait.amplitude": (0.2, 0.9),
        "robot.caudal_fin.length": (0.2, 0.5),
        "robot.n_links": (8, 10),
    },
)


def test_a_gait_beyond_the_limits_of_the_joints_is_not_feasible_and_does_not_swim(
    monkeypatch: pytest.MonkeyPatch,
):
    robot = lc.load_robot("mamba")
    tight = replace(
        robot, joints=tuple(replace(joint, limit=radians(30)) for joint in robot.joints)
    )
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7, offset=radians(5))
    sought = Optimization(
        scenario=lc.build_scenario(tight, gait, 1.0),
        bounds={"gait.amplitude": (0.1, 1.0), "gait.frequency": (1.0, 4.0)},
        joint_rate_limit=1.0,
    )
    swum = []
    monkeypatch.setattr(
        module,
        "swim_points",
        lambda scenario, names, table, threads, loads: swum.append(table) or _figures(len(table)),
    )
    found = module.evaluate(
        sought, np.array([[radians(24), 2.0], [radians(26), 2.0], [radians(24), 3.0]])
    )
    assert found["violation"] == pytest.approx([0.0, 31 / 30 - 1, radians(24) * 3.0 - 1.0])
    assert len(swum) == 1 and swum[0].tolist() == [[radians(24), 2.0]]
    assert np.isnan(found["forward_velocity"]).tolist() == [False, True, True]


def test_a_run_that_is_too_slow_is_not_feasible(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(
        module,
        "swim_points",
        lambda *_, **__: {**_figures(3), "forward_velocity": np.array([0.05, 0.2, np.nan])},
    )
    sought = replace(SOUGHT, least_velocity=0.2)
    found = module.evaluate(sought, np.array([[0.3, 0.3, 9.0], [0.4, 0.3, 9.0], [0.5, 0.3, 9.0]]))
    assert found["violation"].tolist() == [0.75, 0.0, module.FAILED]


def _figures(n: int) -> dict[str, np.ndarray]:
    return {name: np.ones(n, dtype=bool if name == "succeeded" else float) for name in QUANTITIES}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"bounds": {}}, "`bounds` must hold at least one parameter, got none"),
        ({"bounds": iter([1])}, "`bounds` must be of class Mapping, got list_iterator"),
        ({"bounds": {"gait.amplitude": 3}}, "`gait.amplitude` must be a low and a high value, got 3"),
        ({"bounds": {"gait.amplitud": (0.1, 0.2)}}, "`bounds` must name numbers of gait.*nearest are `gait.amplitude`"),
        ({"bounds": {"gait.amplitude": (0.2, 0.2)}}, "`bounds` must have low < high, got 0.2 and 0.2 for `gait.ampl"),
        ({"bounds": {"gait.amplitude": (0.2,)}}, "`bounds` must be a low and a high value of `gait.amplitude`, got 1"),
        ({"bounds": {"gait.amplitude": (-1.0, 0.2)}}, "`bounds` must be within the bounds of the parameters, got gait"),
        ({"bounds": {"robot.n_links": (5.5, 8)}}, "`robot.n_links` must be a whole number, got 5.5"),
        ({"objectives": "speed"}, "`objectives` must be one of `forward_velocity`, .*got 'speed'"),
        ({"objectives": ()}, "`objectives` must be one, or two different ones, got none"),
        ({"objectives": ("mean_power", "mean_power")}, "`objectives` must be one, or two different ones, got"),
        ({"least_velocity": -1.0}, "`least_velocity` must be > 0 m/s, got -1.0"),
        ({"joint_rate_limit": 0.0}, "`joint_rate_limit` must be > 0 rad/s, got 0.0"),
    ],
)  # fmt: skip
def test_bad_input_is_refused(changes: dict[str, object], message: str):
    given = {"scenario": SOUGHT.scenario, "bounds": SOUGHT.bounds}
    with pytest.raises(ValueError, match=message):
        Optimization(**{**given, **changes})  # type: ignore[arg-type]


def a_front(n: int) -> Front:
    """A front whose points crowd at the slow end."""
    power = np.linspace(0.0, 1.0, n) ** 3
    figures = {name: np.full(n, 0.5) for name in QUANTITIES if name != "succeeded"}
    figures |= {"forward_velocity": power**0.5, "mechanical_power": 10.0 * power}
    values = np.stack((np.linspace(0.2, 0.9, n), np.linspace(0.2, 0.5, n), np.full(n, 9.0)), axis=1)
    return Front(
        optimization=SOUGHT, values=values, figures=figures, n_trials=100, n_infeasible=3, seed=1
    )


@pytest.mark.parametrize("levels", [4, 1000])
def test_a_point_is_kept_exactly_if_no_other_one_beats_it(levels: int):
    losses = np.random.default_rng(3).integers(0, levels, (60, 2)).astype(float)
    kept = pareto_front(losses)
    for i, point in enumerate(losses):
        beats = np.all(losses <= point, axis=1) & np.any(losses < point, axis=1)
        first = np.flatnonzero(np.all(losses == point, axis=1))[0] == i
        assert kept[i] == (not beats.any() and first)


def test_of_one_objective_the_first_best_point_is_kept():
    assert pareto_front(np.array([[3.0], [1.0], [1.0]])).tolist() == [False, True, False]
    assert pareto_front(np.empty((0, 2))).size == 0


def test_chosen_points_lie_evenly_along_the_front_with_its_ends():
    front = a_front(400)
    chosen = front.spread(6)
    assert (chosen[0], chosen[-1], len(chosen)) == (0, 399, 6)
    steps = np.hypot(
        np.diff(front.figures["forward_velocity"][chosen]),
        np.diff(front.figures["mechanical_power"][chosen]) / 10,
    )
    assert steps == pytest.approx(np.full(5, steps.mean()), rel=0.05)
    assert a_front(3).spread(6) == [0, 1, 2]


def test_a_point_is_a_robot_and_a_gait():
    scenario = a_front(8).scenario(7)
    robot, gait = scenario.robot, scenario.gait
    assert (robot.n_links, robot.caudal_fin.length, gait.amplitude) == (9, 0.5, 0.9)


def test_files_have_names_units_and_every_point(tmp_path: Path):
    front = a_front(5)
    front.write_csv(tmp_path / "front.csv")
    front.write_netcdf(tmp_path / "front.nc")
    with (tmp_path / "front.csv").open() as file:
        rows = list(csv.reader(file))
    assert rows[0][:4] == [
        "gait.amplitude [rad]",
        "robot.caudal_fin.length [m]",
        "robot.n_links [-]",
        "forward_velocity [m/s]",
    ]
    assert [float(row[0]) for row in rows[1:]] == front.values[:, 0].tolist()
    with xarray.open_dataset(tmp_path / "front.nc") as found:
        assert np.array_equal(found["robot.caudal_fin.length"], front.values[:, 1])
        assert np.array_equal(found["mechanical_power"], front.figures["mechanical_power"])
        assert (found["gait.amplitude"].units, found.n_trials, found.seed) == ("rad", 100, 1)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["front.csv", "front.nc"]


def test_what_lies_at_an_end_of_its_range_is_named():
    values = np.array([[0.2, 0.3, 8.0], [0.9 - 1e-4, 0.4, 8.0], [0.5, 0.41, 9.0]])
    figures = {name: np.arange(3.0) for name in QUANTITIES}
    front = Front(
        optimization=SOUGHT, values=values, figures=figures, n_trials=3, n_infeasible=0, seed=0
    )
    assert front.at_bounds() == [
        {"name": "gait.amplitude", "end": "least", "value": 0.2, "n_points": 1},
        {"name": "gait.amplitude", "end": "greatest", "value": 0.9, "n_points": 1},
        {"name": "robot.n_links", "end": "least", "value": 8.0, "n_points": 2},
    ]
