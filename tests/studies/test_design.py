"""Limits of designs, the search along slopes of objective and limits, and CMA-ES."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from campaign_scripts import campaign

import laticauda as lc
from laticauda.robot import load_servo, servo_names, with_servos
from laticauda.robot.hydrodynamics import link_coefficients
from laticauda.studies import Optimization, judge_design, optimize
from laticauda.studies.cma_search import CmaSearch
from laticauda.studies.limited_search import LimitedSearch
from laticauda.studies.local_model import LocalModel, compute_local_model
from laticauda.studies.optimization import evaluate
from laticauda.studies.quadratic import solve_quadratic

codesign = campaign("codesign")
GAIT = lc.eel_like(amplitude=0.4, frequency=3.0, phase_shift=0.6)
ROBOT = replace(with_servos(lc.load_robot("chain", n_links=4), "xw540-t140"), active_power=0.0)
SCENARIO = lc.build_scenario(ROBOT, GAIT, 2.0, ramp=0.5)
BOUNDS = {
    "robot.module[0].length": (0.1, 0.2),
    "robot.module[2].section.half_width": (0.03, 0.06),
    "robot.module[1].mass": (0.5, 0.8),
    "gait.amplitude[1]": (0.1, 0.6),
    "gait.phase[2]": (-0.5, 0.5),
    "gait.frequency": (2.0, 6.0),
}
SOUGHT = Optimization(
    scenario=SCENARIO,
    bounds=BOUNDS,
    objectives="forward_velocity",
    battery=2.0,
    battery_range=1000.0,
    servo_share=0.5,
    most_mass=3.0,
    buoyancy_tolerance=0.1,
)


def test_a_changed_length_changes_volume_inertia_and_water_as_the_ellipse_says():
    names = {"robot.module[1].length": 0.2, "robot.module[1].section.half_width": 0.04}
    changed = lc.models.simulate.change_parameters(SCENARIO, names)
    module = changed.robot.modules[1]
    a, b, length, mass = 0.03, 0.04, 0.2, 0.6597
    assert module.volume == pytest.approx(math.pi * a * b * length, rel=1e-12)
    # A rod: the integral of x^2 over its length, by a sum of thin slices.
    x = (np.arange(20_000) + 0.5) / 20_000 * length - 0.5 * length
    assert module.moment_of_inertia == pytest.approx(mass * np.mean(x**2), rel=1e-8)
    others = 3 * math.pi * 0.03 * 0.05 * 0.14
    assert changed.robot.volume == pytest.approx(others + math.pi * a * b * length, rel=1e-12)
    water = changed.environment
    loads = link_coefficients(changed.robot, water)
    added = water.density * math.pi * water.added_mass * a**2 * length
    drag = 0.5 * water.density * water.normal_drag * 2.0 * a * length
    assert loads.mu_n[1] == pytest.approx(added, rel=1e-12)
    assert loads.c_n[1] == pytest.approx(drag, rel=1e-12)
    assert loads.displaced[1] == pytest.approx(water.density * math.pi * a * b * length, rel=1e-12)


def test_slopes_of_objective_and_limits_are_those_of_differences():
    point = np.array([0.15, 0.045, 0.66, 0.35, 0.1, 3.3])
    model = compute_local_model(SOUGHT, point)
    assert model is not None
    steps = 1e-5 * np.array([high - low for low, high in BOUNDS.values()])
    table = np.vstack((point + np.diag(steps), point - np.diag(steps)))
    loose = replace(SOUGHT, beyond_actuators=True)
    results = evaluate(loose, table)
    speed = (results["forward_velocity"][:6] - results["forward_velocity"][6:]) / (2.0 * steps)
    np.testing.assert_allclose(model.slope, -speed, rtol=1e-5, atol=1e-6 * np.abs(speed).max())
    joules = results["mean_power"] + ROBOT.idle_power
    share = joules / results["speed_through_water"] * 1000.0 / (2.0 * 3600.0)
    battery = (share[:6] - share[6:]) / (2.0 * steps)
    np.testing.assert_allclose(
        model.excess_slopes[0], battery, rtol=1e-4, atol=1e-5 * np.abs(battery).max()
    )
    mass, heavier, lighter = model.excess_slopes[-3:]
    assert mass == pytest.approx([0.0, 0.0, 1.0 / 3.0, 0.0, 0.0, 0.0], abs=1e-8)
    np.testing.assert_allclose(heavier, -lighter)
    assert model.n_exact == 3


def test_a_quadratic_program_ends_where_its_limits_say():
    slope = np.array([-2.0, -1.0])
    change = solve_quadratic(
        slope,
        np.zeros((2, 2)),
        np.array([-1.0]),
        np.array([[1.0, 1.0]]),
        np.array([-1.0, -1.0]),
        np.array([0.75, 1.0]),
    )
    assert change == pytest.approx([0.75, 0.25], abs=1e-6)
    impossible = solve_quadratic(
        slope,
        np.zeros((2, 2)),
        np.array([3.0]),
        np.array([[1.0, 1.0]]),
        np.array([-1.0, -1.0]),
        np.array([1.0, 1.0]),
    )
    assert impossible == pytest.approx([-1.0, -1.0], abs=1e-6)


class Disk:
    """The point of a disk farthest along (1, 1): both numbers 1/sqrt(2)."""

    model_cost = 1
    is_stepped = np.array([False, False])

    def model_at(self, point: np.ndarray) -> LocalModel:
        return LocalModel(
            slope=np.array([-1.0, -1.0]),
            excess=np.array([point @ point - 1.0]),
            excess_slopes=2.0 * point[np.newaxis],
            n_exact=0,
        )

    def exceed_exactly(self, point: np.ndarray) -> np.ndarray:
        return np.empty(0)

    def round_steps(self, points: np.ndarray) -> np.ndarray:
        return points


def test_a_search_along_slopes_ends_on_a_bent_limit():
    search = LimitedSearch(np.array([0.1, 0.5]), Disk(), np.zeros(2), np.full(2, 2.0), seed=1)
    best = 0.0
    for _ in range(25):
        points = search.ask()
        violation = np.maximum(np.sum(points**2, axis=1) - 1.0, 0.0)
        search.tell(-np.sum(points, axis=1, keepdims=True), violation)
        best = max(best, float(np.max(np.sum(points, axis=1)[violation == 0.0], initial=0.0)))
    assert best == pytest.approx(math.sqrt(2.0), abs=3e-3)


def test_cma_es_with_the_same_seed_tries_the_same_points_and_leaves_other_numbers_alone():
    def run(seed: int) -> np.ndarray:
        search = CmaSearch(np.full(4, 0.5), np.zeros(4), np.ones(4), seed=seed)
        for _ in range(3):
            points = search.ask()
            search.tell(np.sum(points**2, axis=1, keepdims=True), np.zeros(len(points)))
        return search.ask()

    np.random.seed(5)  # noqa: NPY002
    expected = np.random.random()  # noqa: NPY002
    np.random.seed(5)  # noqa: NPY002
    first = run(3)
    np.testing.assert_array_equal(first, run(3))
    assert not np.array_equal(first, run(4))
    assert np.random.random() == expected  # noqa: NPY002


def test_a_design_keeps_its_limits_and_lengths_in_steps():
    sought = replace(SOUGHT, length_step=0.005, battery=200.0)
    front = optimize(sought, budget=80, seed=1)
    judgment = judge_design(sought, front.scenario(0))
    assert judgment.is_feasible, judgment.refusals
    length = front.scenario(0).robot.modules[0].length
    assert length / 0.005 == pytest.approx(round(length / 0.005), abs=1e-9)
    assert front.n_trials + front.n_slope_trials <= 80 + 8 + 34
    assert judgment.trial.forward_velocity > judge_design(sought).trial.forward_velocity


@pytest.mark.parametrize(("bounds", "step"), [((0.101, 0.149), 0.05), ((0.1, 0.2), 5.0)])
def test_a_step_of_lengths_has_a_multiple_within_the_bounds(bounds, step):
    name = "robot.module.length"
    with pytest.raises(
        ValueError,
        match=rf"`length_step` must have a multiple within the bounds of `{name}`, .* got {step:g} m",
    ):
        Optimization(
            scenario=SCENARIO,
            bounds={name: bounds},
            objectives="forward_velocity",
            length_step=step,
        )


def test_a_step_of_lengths_is_refused_where_no_length_varies():
    message = r"`length_step` must be left out if no length of a module varies, got 0.001 m"
    with pytest.raises(ValueError, match=message):
        Optimization(
            scenario=SCENARIO,
            bounds={"gait.frequency": (1.0, 2.0)},
            objectives="forward_velocity",
            length_step=0.001,
        )


def test_tapered_lengths_are_no_multiples_of_a_step():
    with pytest.raises(ValueError, match=r"`length_step` must be left out if lengths are tapered"):
        Optimization(
            scenario=SCENARIO,
            bounds={"robot.taper.length.head": (0.1, 0.2)},
            objectives="forward_velocity",
            length_step=0.001,
        )


def test_ballast_makes_every_module_as_heavy_as_its_water():
    light = tuple(replace(module, mass=0.4) for module in ROBOT.modules)
    scenario = replace(SCENARIO, robot=replace(ROBOT, modules=light))
    sought = replace(SOUGHT, scenario=scenario, ballast=True, buoyancy_tolerance=None)
    robot = judge_design(sought).scenario.robot
    assert robot.mass == pytest.approx(1000.0 * robot.volume, rel=1e-12)


def test_a_refused_design_says_why():
    sought = replace(SOUGHT, battery=0.1, most_mass=2.0, servo_share=0.01)
    judgment = judge_design(sought)
    assert not judgment.is_feasible
    assert "mass: 2.64 kg of at most 2" in judgment.refusals
    assert any("of 0.1 Wh for 1000 m" in refusal for refusal in judgment.refusals)
    assert set(judgment.active) == {"mass", "battery", "joints"}
    front = optimize(sought, budget=9, method="cma-es", seed=0)
    assert len(front) == 0
    assert front.refusals == {"mass": 9}


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"battery_range": None}, "must come with one of `battery_range` and `battery_time`"),
        ({"battery": None}, "must be given with `battery_range`"),
        ({"shortest_module": 0.2, "longest_module": 0.1}, "must be >= `shortest_module`, 0.2 m"),
        (
            {"ballast": True},
            "`buoyancy_tolerance` must be left out with `ballast`, .* got 0.1",
        ),
        (
            {"scenario": replace(SCENARIO, robot=replace(ROBOT, active_power=None))},
            "`active_power`",
        ),
    ],
)
def test_limits_that_contradict_each_other_are_refused(changes: dict[str, Any], message: str):
    with pytest.raises(ValueError, match=message):
        replace(SOUGHT, **changes)


def test_every_servo_is_a_servo():
    assert "xw540-t140" in servo_names()
    for name in servo_names():
        servo = load_servo(name)
        assert servo.stated
        assert servo.stall_power >= 0.9 * servo.stall_torque * servo.no_load_speed / 4.0
    with pytest.raises(ValueError, match="there is no servo preset named `xw541`"):
        with_servos(ROBOT, "xw541")


def test_stored_designs_along_slopes_beat_every_run_of_cma_es_for_sixty_numbers():
    runs = codesign.read_table()
    of_masses = [run for run in runs if run.problem == "masses"]
    speeds = {
        method: [run.speed for run in of_masses if run.method == method]
        for method in codesign.METHODS
    }
    assert len(codesign.bounds_of_body(with_masses=True)) == 60
    assert len(speeds["cma-es"]) == 5
    assert min(speeds["slopes"]) > max(speeds["cma-es"])
    of_ballast = [run for run in runs if run.problem == "ballast"]
    fastest = max(of_ballast, key=lambda run: run.speed)
    assert fastest.method == "cma-es"  # as docs/how-to/optimize.md says
    for run in runs:
        assert run.trials <= codesign.BUDGET + 200
        assert max(run.battery, run.utilization / 0.5, run.mass / 7.0) <= 1.0 + 1e-6
