"""A current is not swimming: what a run costs, and which gait is best, rests on the speed through the water."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import laticauda as lc
from laticauda.models.simulate import change_parameters, compute_sensitivities, swim_many
from laticauda.studies import Optimization
from laticauda.studies.optimization import evaluate
from laticauda.trials import describe_sweeping, shown_figures
from laticauda.water.fluid.flow import Flow
from laticauda.water.fluid.waves import Waves

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
STILL = lc.load_water("paper-lateral")
OF_SWIMMING = ("steady_speed_through_water", "strouhal_number", "mechanical_power")
EDDIES = replace(lc.load_current("turbulence"), modes=6)
SPEEDS = ("speed_through_water", "steady_speed_through_water")


def in_water(current: tuple[float, float] | Flow, duration: float = 25.0) -> lc.Trial:
    water = replace(STILL, current=current)
    return lc.swim(lc.build_scenario("mamba", GAIT, duration, environment=water))


@pytest.fixture(scope="module")
def still() -> lc.Trial:
    return in_water((0.0, 0.0))


@settings(max_examples=3, deadline=None)
@given(speed=st.floats(0.05, 0.8), direction=st.floats(-math.pi, math.pi))
@pytest.mark.filterwarnings("ignore::laticauda.values.InfeasibleWarning")
def test_after_the_start_a_robot_swims_in_a_current_as_in_still_water(
    still: lc.Trial, speed: float, direction: float
):
    trial = in_water((speed * math.cos(direction), speed * math.sin(direction)))
    # The robot is at rest over ground at first, and the current turns it a little meanwhile.
    for name in OF_SWIMMING:
        assert getattr(trial, name) == pytest.approx(getattr(still, name), rel=0.01), name
    assert trial.speed_through_water == pytest.approx(still.speed_through_water, rel=0.3)


def test_a_robot_released_into_a_current_at_its_velocity_swims_as_in_still_water(still: lc.Trial):
    drift = np.array([0.3, -0.2])
    moved = replace(
        still,
        center_of_mass=still.center_of_mass + still.time[:, np.newaxis] * drift,
        center_of_mass_velocity=still.center_of_mass_velocity + drift,
        scenario=replace(still.scenario, environment=replace(STILL, current=(0.3, -0.2))),
    )
    for name in (*SPEEDS, *OF_SWIMMING, "cost_of_transport", "joules_per_meter"):
        assert getattr(moved, name) == pytest.approx(getattr(still, name), rel=1e-9), name
    assert moved.forward_velocity > 2.0 * moved.speed_through_water


def test_in_still_water_the_speeds_through_it_are_those_over_ground_bit_for_bit(still: lc.Trial):
    assert still.speed_through_water == still.forward_velocity
    assert still.steady_speed_through_water == still.steady_velocity
    assert not {figure.name for figure in shown_figures(still)} & {*SPEEDS}


def test_in_waves_the_speed_through_the_water_is_that_of_still_water_within_a_tenth(
    still: lc.Trial,
):
    trial = in_water(Waves(height=0.1, length=6.0))
    assert trial.speed_through_water == pytest.approx(still.speed_through_water, rel=0.1)
    longer = in_water(Waves(height=0.1, length=6.0), 26.3)  # not a whole number of periods
    assert longer.speed_through_water == pytest.approx(trial.speed_through_water, rel=0.02)


def test_a_robot_that_is_swept_backward_is_told_so(still: lc.Trial):
    assert describe_sweeping(still) == ""
    assert describe_sweeping(in_water((0.5, 0.0))) == ""
    sentence = describe_sweeping(in_water((-1.0, 0.0), 10.0))
    assert sentence.startswith("The water sweeps the robot backward: it heads ")
    assert sentence.endswith(" deg.") and "but travels toward " in sentence


def test_on_ground_there_is_no_speed_through_water_and_costs_rest_on_that_over_ground():
    ground = lc.load_ground("viscous")
    trial = lc.swim("mamba", GAIT, 12.0, environment=ground)
    found = swim_many("mamba", GAIT, 12.0, environments=ground)
    for name in SPEEDS:
        with pytest.raises(ValueError, match="must be water for a speed through the water"):
            getattr(trial, name)
        assert np.isnan(getattr(found, name)[0])
    assert trial.joules_per_meter == trial.mean_power / trial.forward_velocity
    assert found.cost_of_transport[0] == pytest.approx(trial.cost_of_transport)


@pytest.mark.parametrize("current", [(-0.2, 0.1), Waves(height=0.1, length=6.0)])
def test_a_batch_has_the_same_speeds_through_the_water_as_single_runs(current: Flow):
    trial = in_water(current)
    found = swim_many([trial.scenario])
    for name in (*SPEEDS, "cost_of_transport"):
        assert getattr(found, name)[0] == pytest.approx(getattr(trial, name), rel=1e-9), name


@pytest.mark.parametrize(
    ("current", "name"),
    [
        ((-0.2, 0.1), "gait.frequency"),
        ((0.0, 0.0), "water.current_x"),
        (Waves(height=0.1, length=6.0), "gait.frequency"),
        (Waves(height=0.1, length=6.0), "water.normal_drag"),
        (EDDIES, "gait.amplitude"),
        (EDDIES, "water.normal_drag"),
    ],
)
def test_the_speed_through_the_water_is_differentiated_as_differences_say(
    current: tuple[float, float] | Flow, name: str
):
    scenario = in_water(current, 15.0).scenario
    step = 1e-4
    found = compute_sensitivities([scenario], names=[name])
    value = found.point[0, 0]
    changed = swim_many(
        [change_parameters(scenario, {name: value + side * step}) for side in (1.0, -1.0)]
    )
    for figure in SPEEDS:
        slope = -np.diff(getattr(changed, figure))[0] / (2.0 * step)
        assert found.of(figure, name)[0] == pytest.approx(slope, rel=1e-3, abs=1e-5), figure

    def relative_slope(figure: str) -> float:
        return found.of(figure, name)[0] / found.values[0, found.figures.index(figure)]

    of_cost = relative_slope("mean_power") - relative_slope("speed_through_water")
    assert relative_slope("cost_of_transport") == pytest.approx(of_cost, rel=1e-9)


def test_the_best_gait_in_a_current_is_the_best_in_still_water_and_not_the_one_that_drifts():
    bounds = {"gait.amplitude": (0.0, 0.7)}
    amplitudes = np.array([[0.05], [0.2], [0.4], [0.6]])
    best: list[int] = []
    for current in ((0.0, 0.0), (-1.0, 0.0)):
        water = replace(STILL, current=current)
        scenario = lc.build_scenario("mamba", GAIT, 25.0, environment=water)
        sought = Optimization(
            scenario=scenario,
            bounds=bounds,
            objectives=("steady_velocity", "cost_of_transport"),
            least_velocity=0.03,
            beyond_actuators=True,
        )
        results = evaluate(sought, amplitudes)
        best.append(int(np.argmax(results[sought.objectives[0]])))
        assert results["violation"][0] > 0.0  # too slow, however fast it drifts
        assert results["violation"][2] == 0.0
    assert best == [3, 3]
    assert sought.objectives == ("steady_speed_through_water", "cost_of_transport")
    assert np.argmax(results["forward_velocity"]) == 0  # the best drift


def test_objectives_count_twice_only_once_the_water_moves():
    scenario = lc.build_scenario("mamba", GAIT, 5.0)
    both = ("forward_velocity", "speed_through_water")
    still = Optimization(scenario=scenario, bounds={"gait.amplitude": (0.1, 0.7)}, objectives=both)
    assert still.objectives == both
    with pytest.raises(ValueError, match="`objectives` must be one, or two different ones, got"):
        Optimization(scenario=scenario, bounds={"water.current_x": (-0.1, 0.1)}, objectives=both)
