"""Networks in lanes: `swim_many` moves each robot as `swim` moves it alone, at many times the speed."""

from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.control.neural import Feedback, HalfCenters, NeuralGait, PhaseOscillators

GAIT = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40)
FEEDBACK = Feedback(pressure=0.08, stretch=-3.0)
FOLLOWING = lc.PathFollowing(
    gait=replace(GAIT, offset=0.02),
    path=lc.StraightLine(),
    guidance=lc.LineOfSight(look_ahead_distance=1.6),
    heading=lc.HeadingController(gain=0.3, max_offset_deg=20),
    interval=0.1,
)


def differing(kind, **changes):
    """Three networks that differ in all that networks of a kind may differ in."""
    networks = []
    for i in range(3):
        gait = replace(GAIT, amplitude=0.3 + 0.1 * i, frequency=2.0 + 0.1 * i, offset=0.05 * i)
        feedback = FEEDBACK if i > 0 else Feedback()
        networks.append(
            kind(gait=gait, feedback=feedback, cuts=tuple(range(i)), seed=i, spread=0.05, **changes)
        )
    return networks


class FollowingOneByOne(lc.PathFollowing):
    """Steers as its base; written for one robot."""

    @classmethod
    def vectorize(cls, controllers):
        return None


class Faster(PhaseOscillators):
    """A network of one's own, whose formulas are written for one."""

    def initial_phases(self, drive):
        return 1.1 * super().initial_phases(drive)


NETWORKS = {
    "oscillators": [
        replace(network, coupling=4.0 + i) for i, network in enumerate(differing(PhaseOscillators))
    ],
    "half centers": [
        replace(network, fatigue=2.5 + 0.1 * i) for i, network in enumerate(differing(HalfCenters))
    ],
    "without seed": [PhaseOscillators(gait=GAIT), PhaseOscillators(gait=replace(GAIT, offset=0.1))],
    "steered": differing(PhaseOscillators, steering=FOLLOWING),
    "steered one by one": differing(HalfCenters, steering=FollowingOneByOne(**vars(FOLLOWING))),
    "of one's own": differing(Faster),
    "steered at other times": [
        PhaseOscillators(gait=GAIT, steering=FOLLOWING),
        PhaseOscillators(gait=GAIT, steering=replace(FOLLOWING, interval=0.2)),
    ],
}


@pytest.mark.parametrize("networks", NETWORKS.values(), ids=list(NETWORKS))
def test_networks_side_by_side_swim_as_each_alone(networks):
    first = lc.build_scenario("mamba", networks[0], 2.0, joints="ekeberg")
    scenarios = [
        replace(first, motion=network, start=lc.Start(center_of_mass=(0.0, 0.1 * i)))
        for i, network in enumerate(networks)
    ]
    swims = lc.swim_many(scenarios, threads=1)
    for i, scenario in enumerate(scenarios):
        trial = lc.swim(scenario)
        alone = [*trial.center_of_mass[-1], trial.heading[-1], trial.mean_power]
        together = [*swims.center_of_mass[i], swims.heading[i], swims.mean_power[i]]
        np.testing.assert_allclose(together, alone, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", ["oscillators", "half centers", "without seed", "steered"])
def test_networks_of_the_package_are_stepped_by_arrays(name):
    networks = NETWORKS[name]
    assert type(networks[0]).vectorize(networks) is not None


def test_networks_whose_formulas_are_ones_own_are_stepped_one_by_one():
    assert Faster.vectorize(NETWORKS["of one's own"]) is None


class Thoughtless(HalfCenters):
    """A network whose formula is missing."""

    rates = NeuralGait.rates


def test_a_network_without_a_formula_says_so():
    rule = "Thoughtless has neither `rates` nor `move`"
    with pytest.raises(NotImplementedError, match=rule):
        lc.swim("mamba", Thoughtless(gait=GAIT), 0.1, joints="servo")
