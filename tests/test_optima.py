"""Published optima, swum again; the published numbers themselves are a user's file (docs: What to trust)."""

import math
from dataclasses import replace

import numpy as np
import pytest
from campaign_scripts import campaign

import laticauda as lc
from laticauda.motion.gaits import Anguilliform, EelLike
from laticauda.paper import Repeat

optima = campaign("optima")
run_optima = optima.run_optima

GAITS = (
    lc.lateral_undulation(
        amplitude=math.radians(40), frequency=math.radians(210), phase_shift=math.radians(20)
    ),
    lc.lateral_undulation(
        amplitude=math.radians(35), frequency=math.radians(210), phase_shift=math.radians(45)
    ),
    *(
        lc.eel_like(
            amplitude=math.radians(alpha),
            frequency=math.radians(210),
            phase_shift=math.radians(delta),
        )
        for alpha, delta in ((60, 26), (52, 35), (50, 45), (58, 55), (72, 70))
    ),
)


def rows(speeds=None, powers=None):
    speeds = np.full(len(GAITS), 0.5) if speeds is None else speeds
    powers = np.full(len(GAITS), 5.0) if powers is None else powers
    return tuple(
        Repeat(gait=gait, has_fin=False, forward_velocity=(float(v),), mean_power=(float(p),))
        for gait, v, p in zip(GAITS, speeds, powers, strict=True)
    )


@pytest.fixture(scope="module")
def found():
    return run_optima(rows())


def test_what_is_published_from_here_is_met(found):
    speeds, powers = np.concatenate([one.simulated for one in found], axis=1)
    again = run_optima(rows(speeds, powers))
    assert [one.gait for one in again] == ["lateral undulation", "anguilliform motion"]
    assert all(np.all(np.abs(one.errors) < 1e-9) for one in again)


def test_the_conventions_are_those_of_the_optimization(found):
    water = lc.Water(
        name="textbook",
        tangential_friction=0.03,
        normal_drag=2.0,
        added_mass=1.0,
        added_mass_form="classic",
    )
    gait = replace(GAITS[3], envelope=Anguilliform())
    trial = lc.swim(lc.load_robot("mamba", n_links=10), gait, 30.0, environment=water, joints="pd")
    net = np.mean(np.sum(trial.joint_torque * trial.joint_rate, axis=1))
    assert found[1].simulated[0, 1] == pytest.approx(trial.forward_velocity, rel=1e-9)
    assert found[1].simulated[1, 1] == pytest.approx(net, rel=1e-2)


def test_the_envelope_of_the_paper_swims_4_to_10_percent_slower_and_takes_less_power(found):
    _, paper = run_optima(rows(), EelLike())
    speed, power = paper.simulated / found[1].simulated
    assert paper.gait == "eel-like motion"
    assert np.all((speed > 0.90) & (speed < 0.96))
    assert np.all((power > 0.70) & (power < 0.93))


def test_what_cannot_be_compared_is_refused():
    with pytest.raises(ValueError, match="`rows` must be without fin and each have a power"):
        run_optima((replace(rows()[0], has_fin=True),))
    with pytest.raises(ValueError, match="`rows` must be without fin and each have a power"):
        run_optima((replace(rows()[0], mean_power=(None,)),))


def test_the_figure_shows_every_optimum_twice(found):
    figure = optima.optima_figure(found)
    shown = [
        sum(len(line.get_xdata()) for line in ax.lines if line.get_marker() != "None")
        for ax in figure.axes
    ]
    assert shown == [len(GAITS)] * 2
    assert [ax.get_xlabel() for ax in figure.axes] == [
        "published forward velocity [m/s]",
        "published net power [W]",
    ]
    assert [ax.get_xscale() for ax in figure.axes] == ["linear", "log"]
