from dataclasses import replace
from math import radians

import numpy as np
import pytest

import laticauda as lc
from laticauda.studies import Optimization
from laticauda.studies import optimization as module
from laticauda.studies.trials import QUANTITIES

SOUGHT = Optimization(
    scenario=lc.scenario("mamba-fin", lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7)),
    bounds={"gait.amplitude": (0.2, 0.9), "robot.caudal_fin.length": (0.2, 0.5), "robot.n_links": (8, 10)},
)


def test_a_gait_beyond_the_limits_of_the_joints_is_not_feasible_and_does_not_swim(monkeypatch: pytest.MonkeyPatch):
    robot = lc.load_robot("mamba")
    tight = replace(robot, joints=tuple(replace(joint, limit=radians(30)) for joint in robot.joints))
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7, offset=radians(5))
    sought = Optimization(
        scenario=lc.scenario(tight, gait, 1.0),
        bounds={"gait.amplitude": (0.1, 1.0), "gait.frequency": (1.0, 4.0)},
        joint_rate_limit=1.0,
    )
    swum = []
    monkeypatch.setattr(
        module.trials, "swim_points", lambda scenario, names, table, threads: swum.append(table) or _figures(len(table))
    )
    found = module.evaluate(sought, np.array([[radians(24), 2.0], [radians(26), 2.0], [radians(24), 3.0]]))
    assert found["violation"] == pytest.approx([0.0, 31 / 30 - 1, radians(24) * 3.0 - 1.0])
    assert len(swum) == 1 and swum[0].tolist() == [[radians(24), 2.0]]
    assert np.isnan(found["forward_velocity"]).tolist() == [False, True, True]


def test_a_run_that_is_too_slow_is_not_feasible(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(
        module.trials, "swim_points", lambda *_: {**_figures(3), "forward_velocity": np.array([0.05, 0.2, np.nan])}
    )
    sought = replace(SOUGHT, least_velocity=0.2)
    found = module.evaluate(sought, np.array([[0.3, 0.3, 9.0], [0.4, 0.3, 9.0], [0.5, 0.3, 9.0]]))
    assert found["violation"].tolist() == [0.75, 0.0, module.FAILED]


def _figures(n: int) -> dict[str, np.ndarray]:
    return {name: np.ones(n, dtype=bool if name == "succeeded" else float) for name in QUANTITIES}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"bounds": {}}, "`bounds` must name at least one parameter, got none"),
        ({"bounds": {"gait.amplitud": (0.1, 0.2)}}, "`bounds` must name numbers of gait.*nearest are `gait.amplitude`"),
        ({"bounds": {"gait.amplitude": (0.2, 0.2)}}, "`bounds` must have low < high, got 0.2 and 0.2 for `gait.ampl"),
        ({"bounds": {"gait.amplitude": (0.2,)}}, "`bounds` must be a low and a high value of `gait.amplitude`, got 1"),
        ({"bounds": {"gait.amplitude": (-1.0, 0.2)}}, "`bounds` must be within the bounds of what is swept, got gait"),
        ({"bounds": {"robot.n_links": (5.5, 8)}}, "`robot.n_links` must be a whole number, got 5.5"),
        ({"objectives": "speed"}, "`objectives` must be one of `forward_velocity`, .*got 'speed'"),
        ({"objectives": ()}, "`objectives` must be one, or two that differ, got none"),
        ({"objectives": ("mean_power", "mean_power")}, "`objectives` must be one, or two that differ, got mean_power"),
        ({"least_velocity": -1.0}, "`least_velocity` must be > 0 m/s, got -1.0"),
        ({"joint_rate_limit": 0.0}, "`joint_rate_limit` must be > 0 rad/s, got 0.0"),
    ],
)  # fmt: skip
def test_bad_input_is_refused(changes: dict[str, object], message: str):
    given = {"scenario": SOUGHT.scenario, "bounds": SOUGHT.bounds}
    with pytest.raises(ValueError, match=message):
        Optimization(**{**given, **changes})  # type: ignore[arg-type]
