from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.compiling.pullbacks import NotTraceable
from laticauda.models.planar import batch, pullbacks, reverse, rows
from laticauda.models.simulate import (
    batch_scenarios,
    build_plant,
    compute_sensitivities,
    row_derivatives,
)
from laticauda.models.simulate.numbers import UNITS, change_parameters, value_of
from laticauda.robot import Tether, load_robot, load_water
from laticauda.scenarios import Command, OpenLoop
from laticauda.water.fluid.laws import FunctionDrag, PolynomialDrag, TotalSpeedDrag

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.31, phase_shift=0.7, offset=0.03)
FINNED = replace(load_robot("mamba-fin"), tether=Tether(drag=0.8))
WATER = replace(
    load_water("paper-lateral"),
    tangential_added_mass=0.1,
    current=(0.03, -0.02),
    friction_taper=0.3,
)
NAMES = (
    "gait.amplitude",
    "gait.frequency",
    "gait.phase_shift",
    "gait.offset",
    "water.tangential_friction",
    "water.normal_drag",
    "water.added_mass",
    "water.friction_taper",
    "water.density",
    "water.current_y",
    "robot.module.length",
    "robot.module.mass",
    "robot.module.section.half_height",
    "robot.joint.actuator.tracking",
    "robot.caudal_fin.length",
    "robot.tether.drag",
)

UNKNOWN_WITH_FLOW = ("speed_through_water", "steady_speed_through_water", "cost_of_transport")
"""Figures whose derivatives to the numbers of a flow itself are nan."""


def by_differences(robot, gait, water, names, **settings):
    """The same Jacobian by central differences of three steps, extrapolated after Richardson.

    Small steps: |u phi'| and |v| v have kinks, and a difference is of no use once one of them
    passes a time step.
    """
    steps = 2.0 ** -np.arange(19, 22)
    scenario, points = lc.build_scenario(robot, gait, environment=water, **settings), []
    for name in names:
        value = compute_sensitivities(
            robot, gait, 0.1, environments=water, names=[name], **settings
        ).point[0, 0]
        points += [
            (change_parameters(scenario, {name: value * (1 + s * h)}), value)
            for h in steps
            for s in (1, -1)
        ]
    scenarios, values = zip(*points, strict=True)
    many = lc.swim_many(scenarios)
    end = dict(zip("xy", many.center_of_mass.T, strict=True))
    columns = [end[figure] if figure in end else getattr(many, figure) for figure in UNITS]
    y = np.reshape(columns, (len(UNITS), len(names), 3, 2))
    slope = (y[..., 0] - y[..., 1]) / (2.0 * steps * np.reshape(values, (len(names), 3, 2))[..., 0])
    better = (4.0 * slope[..., 1:] - slope[..., :-1]) / 3.0
    return (16.0 * better[..., 1] - better[..., 0]) / 15.0


def test_figures_follow_the_numbers_of_a_flow():
    flow = replace(lc.load_current("turbulence"), modes=6)
    water = replace(load_water("paper-lateral"), current=flow)
    names = (
        "water.current.intensity",
        "water.current.mean_x",
        "water.current.largest",
        "water.current.evolution",
    )
    found = compute_sensitivities(load_robot("mamba"), GAIT, 30.0, environments=water, names=names)
    expected = by_differences(load_robot("mamba"), GAIT, water, names)
    # How the path of the water itself changes is not computed, and not told wrongly.
    is_unknown = np.isin(found.figures, UNKNOWN_WITH_FLOW)
    assert np.isnan(found.jacobian[0][is_unknown]).all()
    expected[is_unknown] = np.nan
    check(found, expected, 1e-7)
    with pytest.raises(ValueError, match=r"got `water\.current\.seed`, a count"):
        compute_sensitivities(
            load_robot("mamba"), GAIT, 3.0, environments=water, names=["water.current.seed"]
        )


def check(found, expected, bound):
    """Equal to a share of what the figure makes of the parameter as a whole."""
    scale = np.abs(expected) + np.abs(found.values[0, :, np.newaxis] / found.point[0])
    error = np.abs(found.jacobian[0] - expected) / scale
    np.testing.assert_array_equal(np.isnan(found.jacobian[0]), np.isnan(expected))
    np.testing.assert_array_less(error[np.isfinite(expected)], bound)


def test_derivatives_are_those_of_extrapolated_differences_over_a_whole_trial():
    found = compute_sensitivities(FINNED, GAIT, environments=WATER, names=NAMES, dt=0.05)
    check(found, by_differences(FINNED, GAIT, WATER, NAMES, dt=0.05), 1e-7)
    trial = lc.swim(FINNED, GAIT, environment=WATER, dt=0.05)
    assert found.values[0, 0] == pytest.approx(trial.forward_velocity, rel=1e-10)
    assert found.parameters[1].unit == "rad/s"


@pytest.mark.parametrize(
    ("drag", "own"),
    [
        (PolynomialDrag(sway_friction=0.5), ("sway_friction", "reference_speed")),
        (TotalSpeedDrag(beta=0.4, gamma=0.9), ("beta", "gamma")),
    ],
    ids=["sway friction", "total speed"],
)
def test_friction_that_grows_with_the_sideways_speed_has_its_derivatives(drag, own):
    # Not to the frequency: it moves the kinks of |v_n| past the time steps, where a difference is
    # of no use.
    water = replace(WATER, drag=drag)
    names = [*(f"water.drag.{name}" for name in own), "gait.amplitude", "water.added_mass"]
    found = compute_sensitivities(FINNED, GAIT, environments=water, names=names, dt=0.05)
    check(found, by_differences(FINNED, GAIT, water, names, dt=0.05), 1e-7)


def test_the_dimensionless_form_says_by_how_many_percent():
    found = compute_sensitivities(FINNED, GAIT, names=["gait.amplitude", "water.current_x"])
    share = (
        found.of("net_power", "gait.amplitude")
        * GAIT.amplitude
        / found.values[:, found.figures.index("net_power")]
    )
    assert found.elasticity[:, found.figures.index("net_power"), 0] == pytest.approx(
        share, rel=1e-15
    )
    assert found.elasticity[0, 0, 1] == 0.0


@pytest.mark.parametrize("joints", ["pd", "servo"])
def test_driven_joints_have_derivatives_to_their_actuators_too(joints):
    robot = load_robot("mamba")
    name = {
        "pd": "robot.joint.actuator.proportional_gain",
        "servo": "robot.joint.actuator.stall_torque",
    }[joints]
    found = compute_sensitivities(
        robot, GAIT, 1.0, environments=WATER, names=[name], joints=joints, dt=0.002
    )
    value, step = found.point[0, 0], 1e-5
    scenario = lc.build_scenario(robot, GAIT, 1.0, environment=WATER, joints=joints, dt=0.002)
    many = lc.swim_many(
        [change_parameters(scenario, {name: value * (1 + s)}) for s in (step, -step)]
    )
    for figure in ("forward_velocity", "net_power", "mean_power", "heading"):
        ahead, behind = getattr(many, figure)
        expected = (ahead - behind) / (2 * step * value)
        assert found.of(figure, name)[0] == pytest.approx(expected, rel=1e-5, abs=1e-9), figure


def test_a_batch_has_the_derivatives_of_its_trials():
    gaits = [replace(GAIT, amplitude=a) for a in (0.3, 0.4, 0.5)]
    robots = [load_robot("mamba"), FINNED, load_robot("mamba")]
    names = ["gait.frequency", "water.normal_drag", "robot.module.mass"]
    whole = compute_sensitivities(robots, gaits, 15.0, environments=WATER, names=names, threads=2)
    for i in range(3):
        alone = compute_sensitivities(
            robots[i], gaits[i], 15.0, environments=WATER, names=names[::-1], threads=1
        )
        np.testing.assert_array_equal(whole.values[i], alone.values[0])
        np.testing.assert_allclose(
            whole.jacobian[i], alone.jacobian[0, :, ::-1], rtol=1e-12, atol=1e-15
        )


def test_numbers_at_the_end_of_their_range_are_differentiated_on_one_side():
    # Neither a tether nor tangential added mass: both are at 0, and a tether is a load that the
    # kernels leave out then.
    robot, water = load_robot("mamba"), load_water("paper-lateral")
    names = ["robot.tether.drag", "water.tangential_added_mass"]
    found = compute_sensitivities(robot, GAIT, environments=water, names=names, dt=0.05)
    step = 2.0**-16
    for k, name in enumerate(names):
        scenario = lc.build_scenario(robot, GAIT, environment=water, dt=0.05)
        speed = [
            lc.swim(change_parameters(scenario, {name: j * step})).forward_velocity
            for j in range(3)
        ]
        slope = (-1.5 * speed[0] + 2.0 * speed[1] - 0.5 * speed[2]) / step
        assert found.jacobian[0, 0, k] == pytest.approx(slope, rel=1e-6)
        assert slope < -1e-4 or name != names[0]


def test_a_modules_own_coefficient_begins_at_the_waters():
    found = compute_sensitivities(
        load_robot("mamba"), GAIT, 5.0, names=["robot.module.normal_drag", "water.normal_drag"]
    )
    np.testing.assert_array_equal(found.point[:, 0], found.point[:, 1])
    np.testing.assert_allclose(
        found.jacobian[..., 0], found.jacobian[..., 1], rtol=1e-10, atol=1e-15
    )


@pytest.mark.parametrize("duration", [4.0, 30.0])
def test_many_numbers_are_differentiated_backward_with_the_same_result(duration):
    figures = ["steady_speed_through_water", "mean_power", "heading", "cost_of_transport", "x"]
    gaits = [replace(GAIT, amplitude=a) for a in (0.3, 0.5)]
    settings = {"environments": WATER, "figures": figures}
    backward = compute_sensitivities(FINNED, gaits, duration, names=NAMES, **settings)
    halves = [
        compute_sensitivities(FINNED, gaits, duration, names=names, **settings)
        for names in (NAMES[:8], NAMES[8:])
    ]
    forward = np.concatenate([half.jacobian for half in halves], axis=2)
    np.testing.assert_allclose(backward.values, halves[0].values, rtol=1e-12)
    scale = np.abs(forward).max(axis=2, keepdims=True)
    np.testing.assert_allclose(backward.jacobian / scale, forward / scale, rtol=1e-10, atol=1e-12)
    assert backward.figures == tuple(figures)


def test_a_parameter_of_the_wave_is_a_row_itself():
    run, *_ = batch_scenarios.runs_of([lc.build_scenario(FINNED, GAIT, environment=WATER)])
    for name in ("amplitude", "frequency", "phase_shift", "offset"):
        value = getattr(GAIT, name)
        number = row_derivatives.Number(
            name=name,
            scenario=lc.build_scenario(FINNED, GAIT, environment=WATER),
            value=value,
            change=lambda changed, name=name: lc.build_scenario(
                FINNED, replace(GAIT, **{name: changed}), environment=WATER
            ),
        )
        by_differences = row_derivatives.differentiate_rows(run, number, row_derivatives.LINEAR)
        at_once = row_derivatives.differentiate_wave(run, name)
        np.testing.assert_allclose(at_once.rows, by_differences.rows, atol=1e-13)


def test_laws_and_waters_that_cannot_go_backward_are_differentiated_forward():
    def branching(v_t, v_n, across, rate, element):
        if v_t > 0.0:
            return -element.c_t * v_t, -element.c_n * v_n, 0.0
        return -2.0 * element.c_t * v_t, -element.c_n * v_n, 0.0

    flow = replace(lc.load_current("turbulence"), modes=2)
    for water in (
        replace(WATER, drag=FunctionDrag(function=branching)),
        replace(WATER, current=flow),
    ):
        assert reverse.find_obstacle(build_plant(FINNED, water)) is not None
    assert reverse.find_obstacle(build_plant(FINNED, WATER, joints="pd")) is not None
    assert reverse.find_obstacle(build_plant(FINNED, WATER)) is None


def test_a_fault_in_a_formula_of_the_model_is_not_blamed_on_the_drag_law(monkeypatch):
    def fail(formulas):
        raise NotTraceable("The formula branches.")

    monkeypatch.setattr(pullbacks, "_written", {})
    monkeypatch.setattr(reverse, "_specialized", {})
    monkeypatch.setattr(pullbacks, "_write_of_waves", fail)
    plant = build_plant(FINNED, WATER)
    with pytest.raises(NotTraceable, match="The formula branches"):
        reverse.find_obstacle(plant)


@pytest.mark.usefixtures("limit_case")
@pytest.mark.parametrize("names", [["gait.amplitude"], NAMES], ids=["forward", "backward"])
def test_a_trial_that_diverges_has_no_derivatives(names):
    wild = replace(WATER, normal_drag=1e4)
    found = compute_sensitivities(
        FINNED, GAIT, 14.0, environments=[WATER, wild], names=names, figures=["x", "y"], dt=0.05
    )
    assert found.succeeded.tolist() == [True, False]
    assert np.isfinite(found.jacobian[0]).all()
    assert np.isnan(found.jacobian[1]).all()
    assert "diverged" in found.status[1]


@pytest.mark.parametrize(
    ("names", "message"),
    [
        ([], "`names` must hold at least one name of a parameter, got []."),
        (
            "gait.amplitude",
            "`names` must hold at least one name of a parameter, got 'gait.amplitude'.",
        ),
        (
            ["gait.amplitud"],
            "`names` must name numbers of gait, water or robot, such as `gait.amplitude`, got 'gait",
        ),
        (
            ["robot.n_links"],
            "`names` must be of numbers that can vary slightly, got `robot.n_links`, a count.",
        ),
        (
            ["water.depth"],
            "`names` must be of numbers that the trial has, got `water.depth`, which is None.",
        ),
    ],
)
def test_names_of_no_use_are_refused(names, message):
    with pytest.raises(ValueError) as refused:
        compute_sensitivities(load_robot("mamba"), GAIT, 1.0, names=names)
    assert message in str(refused.value)


def test_modules_that_differ_have_no_common_number():
    robot = load_robot("mamba")
    odd = replace(robot, modules=(replace(robot.modules[0], mass=2.0), *robot.modules[1:]))
    with pytest.raises(ValueError, match=r"the same in all parts, got `robot\.module\.mass`"):
        compute_sensitivities(odd, GAIT, 1.0, names=["robot.module.mass"])


def test_runs_of_a_held_command_are_differentiated_at_that_command():
    """Commanded thrusts, held references and steering are part of the scenario that was run."""
    robot = load_robot("mamba-thruster")
    driven = replace(robot, thrusters=(replace(robot.thrusters[0], max_thrust=6.0),))
    held = tuple(0.2 * np.sin(np.arange(driven.n_links - 1)))
    commands = [
        Command(gait=GAIT, thrusts=(2.0,)),
        Command(gait=GAIT, thrusts=(4.0,)),  # on the same plant: nothing of the first is shared
        Command(gait=GAIT, references=held, offset=0.05),
    ]
    scenario = lc.build_scenario(driven, GAIT, 2.0, joints="pd")
    scenarios = [replace(scenario, motion=OpenLoop(command=command)) for command in commands]
    names = ["robot.thruster.angle", "water.normal_drag"]
    found = compute_sensitivities(scenarios, None, names=names)
    step = 1e-5
    for name, value in zip(names, found.point[0], strict=True):
        after, before = (
            lc.swim_many([change_parameters(each, {name: value + h}) for each in scenarios]).heading
            for h in (step, -step)
        )
        np.testing.assert_allclose(
            found.of("heading", name), (after - before) / (2.0 * step), rtol=1e-5
        )


def test_runs_of_one_plant_with_held_references_do_not_follow_the_gait():
    robot = load_robot("mamba")
    held = Command(gait=GAIT, references=tuple(0.2 * np.sin(np.arange(robot.n_links - 1))))
    scenario = replace(
        lc.build_scenario(robot, GAIT, 1.0, joints="pd"), motion=OpenLoop(command=held)
    )
    (alone,) = lc.swim_many([scenario]).heading
    np.testing.assert_array_equal(lc.swim_many([scenario, scenario]).heading, [alone, alone])


@pytest.mark.parametrize(
    ("robot", "name", "n_evaluations"),
    [
        ("mamba", "robot.module[3].normal_drag", 3),
        ("mamba", "robot.module[3].mass", 6),
        ("mamba-fin", "robot.module.mass", 8),
    ],
)
def test_a_number_is_changed_no_more_often_than_its_formulas_need(robot, name, n_evaluations):
    scenario = lc.build_scenario(robot, GAIT)
    run = batch_scenarios.runs_of([scenario])[0]
    values: list[float] = []

    def change(value: float) -> lc.Scenario:
        values.append(value)
        return change_parameters(scenario, {name: value})

    number = row_derivatives.Number(
        name=name, scenario=scenario, value=value_of(name, scenario), change=change
    )
    rows_per_unit = row_derivatives.differentiate_rows(run, number, row_derivatives.CENTRAL).rows
    assert len(values) == n_evaluations
    if name == "robot.module[3].mass":
        bodies = run.plant.layout.bodies_of(run.rows)
        slopes = run.plant.layout.bodies_of(rows_per_unit)[:, rows.MASS_SHARE]
        of_module = np.arange(len(bodies)) == 3
        expected = (of_module - bodies[:, rows.MASS_SHARE]) / run.plant.robot.mass
        np.testing.assert_allclose(slopes, expected, rtol=1e-13)


def test_numbers_of_a_trial_share_its_run_and_have_the_same_derivatives(monkeypatch):
    names = NAMES[:5]  # three lanes of a trial, the last with a single derivative
    gaits = [GAIT, replace(GAIT, amplitude=0.4)]
    together = compute_sensitivities(FINNED, gaits, 4.0, environments=WATER, names=names)
    monkeypatch.setattr(batch, "MOST_SLOPES", 1)
    apart = compute_sensitivities(FINNED, gaits, 4.0, environments=WATER, names=names)
    np.testing.assert_allclose(together.values, apart.values, rtol=1e-13)
    size = np.abs(apart.jacobian).max(axis=2, keepdims=True)
    assert np.nanmax(np.abs(together.jacobian - apart.jacobian) / size) < 1e-12
