import math
import sys
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.control import AveragedModel, ModelPredictive, Polyline, Spline, StraightLine
from laticauda.trials import following
from laticauda.values.errors import MissingExtra

GAIT = lc.lateral_undulation(
    amplitude=math.radians(30), frequency=math.radians(90), phase_shift=math.radians(40)
)
# What `benchmarks/mpc.py` finds for Mamba with its fin.
MODEL = AveragedModel(
    turn_0=0.024,
    turn_1=0.554,
    bend=1.36,
    bend_lag=0.224,
    speed_0=-0.0026,
    speed_1=0.0831,
    speed_offset=-0.296,
    speed_lag=0.05,
    sway=0.2585,
    sway_lag=1.224,
    power_0=2.756,
    power_1=1.933,
    power_exponent=3.025,
    power_offset=11.0,
)
MPC = ModelPredictive(gait=GAIT, path=StraightLine(), model=MODEL, speed=0.12)
FREE = replace(MPC, frequency_limits=(math.radians(60), math.radians(120)), power_limit=15.0)


def follow(
    controller, duration, current=(0.0, 0.0), *, y=0.5, heading=0.0, robot="mamba-fin", **choices
):
    water = replace(lc.load_water("paper-lateral"), current=current)
    plant = lc.build_plant(lc.load_robot(robot), water, **choices)
    return lc.run(
        plant, controller, duration, start=lc.Start(center_of_mass=(0.0, y), heading=heading)
    )


def mean_error(trial):
    middle, error = following.mean_error(
        trial.time, trial.signals["cross_track_error"], trial.period
    )
    return error[middle > trial.duration - 10.0]


@pytest.mark.parametrize("current", [(0.0, 0.0), (0.0, 0.06), (0.03, -0.03)])
def test_the_robot_comes_to_the_path_and_no_current_keeps_it_away(current):
    trial = follow(replace(MPC, interval=0.4), 60.0, current)
    assert np.abs(mean_error(trial)).max() < 0.02
    drift = [trial.signals[f"drift_{axis}"][-200:].mean() for axis in "xy"]
    np.testing.assert_allclose(drift, current, atol=0.01)
    lag = trial.signals["heading_ref"] - trial.signals["heading_used"]
    assert np.abs(lag[trial.time > 40.0]).max() < 0.1
    assert trial.signals["is_fallback"].max() == 0.0


def test_a_curved_path_is_followed():
    path = Spline(waypoints=((0.0, 0.0), (2.0, 0.4), (4.0, 0.0), (6.0, 0.5)))
    trial = follow(replace(MPC, path=path, interval=0.4), 45.0, y=0.2)
    assert np.abs(mean_error(trial)).max() < 0.06
    assert trial.signals["along_track_distance"][-1] > 4.0


def test_limits_are_kept():
    trial = follow(
        replace(FREE, max_offset=0.2, offset_rate=0.1, frequency_rate=0.05),
        40.0,
        (0.0, 0.06),
        y=1.5,
    )
    f, offset = trial.signals["frequency"], trial.signals["offset"]
    assert np.ptp(f) > 0.1
    assert np.abs(offset).max() == pytest.approx(0.2, abs=1e-6)
    assert f.min() >= math.radians(60) - 1e-12
    assert f.max() <= math.radians(120) + 1e-12
    assert np.abs(np.diff(offset)).max() <= 0.1 * 0.2 + 1e-9
    assert np.abs(np.diff(f)).max() <= 0.05 * 0.2 + 1e-9
    assert MODEL.power(f, offset).max() <= 15.0 + 1e-3


def test_a_tighter_power_limit_takes_less_power():
    tight, wide = (
        follow(replace(FREE, power_limit=limit, interval=0.4), 40.0, (-0.04, 0.0))
        for limit in (10.0, 20.0)
    )
    assert tight.mechanical_power < wide.mechanical_power
    assert np.median(
        MODEL.power(tight.signals["frequency"], tight.signals["offset"])
    ) == pytest.approx(10.0, abs=0.1)


def seen(y, heading, time=0.0):
    nothing = np.zeros(1)
    return lc.Observation(
        time=time,
        center_of_mass=np.array([0.0, y]),
        center_of_mass_velocity=np.zeros(2),
        heading=heading,
        heading_rate=0.0,
        link_angle=nothing,
        joint_angle=nothing,
        joint_rate=nothing,
    )


def commands(controller, sign=1.0, turn=0.0):
    """What it says to a robot that comes to the path, mirrored or with the path turned."""
    state, said = controller.init(), []
    c, s = math.cos(turn), math.sin(turn)
    for k in range(12):
        observation = seen(0.0, sign * 0.2 * math.sin(0.3 * k) + turn, 0.2 * k)
        x, y = 0.02 * k, sign * (0.8 - 0.01 * k)
        state, command = controller.step(
            state, replace(observation, center_of_mass=np.array([c * x - s * y, s * x + c * y]))
        )
        said.append((command.gait.frequency, command.offset))
    return np.array(said)


def test_a_mirrored_robot_gets_the_mirrored_command():
    usual = commands(FREE)
    assert np.ptp(usual[:, 1]) > 0.05
    np.testing.assert_allclose(commands(FREE, -1.0), usual * (1.0, -1.0), atol=1e-5)


def test_a_path_that_is_turned_gets_the_same_command():
    np.testing.assert_allclose(
        commands(replace(FREE, path=StraightLine(angle=2.5)), turn=2.5), commands(FREE), atol=1e-5
    )


def test_the_same_state_and_observation_give_the_same_answer():
    state, _ = FREE.step(FREE.init(), seen(0.5, 0.1))
    first, second = (FREE.step(state, seen(0.49, 0.1, 0.2))[1] for _ in range(2))
    assert first == second


def test_where_there_is_no_plan_line_of_sight_takes_over_and_says_so():
    hasty = replace(MPC, iterations=1, interval=0.4)
    trial = follow(hasty, 90.0)
    assert trial.signals["is_fallback"].min() == 1.0
    assert np.abs(mean_error(trial)).max() < 0.1
    assert trial.succeeded


def test_corners_do_not_stop_it():
    trial = follow(
        replace(MPC, path=Polyline(waypoints=((0, 0), (2, 0), (4, 2))), interval=0.4), 45.0, y=0.0
    )
    assert trial.signals["is_fallback"].mean() < 0.1
    assert trial.signals["along_track_distance"][-1] > 3.5


def test_the_trial_keeps_how_it_was_made():
    trial = follow(MPC, 2.0)
    assert trial.scenario.motion == MPC
    np.testing.assert_allclose(
        trial.signals["cross_track_error"][:-1:4], trial.center_of_mass[:-1:4, 1], atol=1e-12
    )


def test_without_casadi_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "casadi", None)
    fresh = replace(MPC, speed=0.1234)  # no solver of another test is kept for it
    with pytest.raises(MissingExtra, match=r'control needs CasADi; run `pip install .*\[mpc\]"`'):
        fresh.step(fresh.init(), seen(0.5, 0.0))


def test_a_robot_whose_joints_cannot_bend_that_far_is_refused():
    with pytest.raises(
        ValueError, match=r"`max_offset` must be <= 1\.047 rad, or joint 0 goes beyond its limit"
    ):
        follow(replace(MPC, max_offset=1.2), 1.0)


@pytest.mark.parametrize(
    ("choices", "message"),
    [
        ({"speed": 0.0}, "`speed` must be > 0 m/s, got 0.0"),
        ({"interval": 0.1}, r"`interval` must be >= 0\.2 s, got 0\.1"),
        ({"horizon": 0}, "`horizon` must be a whole number >= 1, got 0"),
        ({"iterations": 1.5}, r"`iterations` must be a whole number >= 1, got 1\.5"),
        ({"offset_rate": math.nan}, "`offset_rate` must be a finite number in rad/s, got nan"),
        (
            {"frequency_limits": (1.0, 1.2)},
            r"`frequency_limits` must enclose the gait's frequency of 1\.571 rad/s",
        ),
        ({"frequency_limits": (1.0,)}, "`frequency_limits` must be two numbers in rad/s, got 1"),
        (
            {"power_limit": 5.0},
            r"`power_limit` must be >= 15\.\d+ W, the power at the lowest frequency",
        ),
        ({"power_limit": math.nan}, "`power_limit` must be a finite number in W, got nan"),
        ({"model": 3}, "`model` must be of class AveragedModel, got int"),
    ],
)
def test_a_bad_field_is_refused(choices, message):
    with pytest.raises(ValueError, match=message):
        replace(MPC, **choices)
