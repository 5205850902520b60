"""Names of single parts and of ranges: one reader for sweeps, optimization, identification and options."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.cli.vary import RANGE_FORM, parse_grid, parse_ranges
from laticauda.models.simulate import compute_sensitivities, list_parameters, swim_many
from laticauda.models.simulate.numbers import (
    change_parameters,
    check_disjoint,
    look_up,
    value_of,
)
from laticauda.models.simulate.run_table import check_columns
from laticauda.models.simulate.table_run import run_columns
from laticauda.studies import Grid, Optimization, Sweep

GAIT = lc.eel_like(amplitude=0.5, frequency=6.0, phase_shift=0.7)
# With a fixed time step, so that differences to the frequency are of the same steps.
SCENARIO = lc.build_scenario("mamba", GAIT, duration=2.0, dt=0.01)
KNOWN = list_parameters(SCENARIO)
N = SCENARIO.robot.n_links
ENDS = ("tail", "head", "bulge")


def test_every_part_has_a_name_without_being_listed():
    assert "robot.module[3].mass" not in set(KNOWN)
    assert "robot.module[3].mass" in KNOWN
    assert KNOWN["robot.module[3].mass"].unit == "kg"
    assert KNOWN["robot.module[:5].mass"].phrase == "mass of modules [:5]"
    assert KNOWN["robot.joint[::2].stiffness"].unit == "N m/rad"
    listed = list_parameters(SCENARIO, each=True)
    assert {name for name in listed if name not in KNOWN} == set()
    assert all(listed[name] == KNOWN[name] for name in listed)


@pytest.mark.parametrize(
    "name",
    [
        f"robot.module[{N}].mass",
        "robot.module[-1].mass",
        "robot.module[3].nothing",
        "robot.module[].mass",
        "robot.module[::0].mass",
        "robot[0].module.mass",
        "robot.mass[3]",
        "nothing.module[3].mass",
    ],
)
def test_what_is_no_part_has_no_name(name: str):
    assert name not in KNOWN
    with pytest.raises(ValueError, match="`points` must name numbers of gait, water or robot"):
        look_up(name, KNOWN)


def test_a_part_that_is_not_there_is_refused_with_how_parts_count():
    of_modules = (
        r"`robot\.module` counts from \[0\] at the tail to \[8\], or in ranges such as \[:9\]"
    )
    for brackets in (f"[{N}]", "[-1]", "[a]", "[5:3]"):
        with pytest.raises(ValueError, match=of_modules):
            look_up(f"robot.module{brackets}.mass", KNOWN)
    for name in ("gait.phase[8]", "gait.amplitude[-1]", "robot.joint[20].limit"):
        with pytest.raises(ValueError, match=r"counts from \[0\] at the tail to \[7\]"):
            look_up(name, KNOWN)
        with pytest.raises(ValueError, match=r"counts from \[0\] at the tail to \[7\]"):
            parse_grid([f"{name}-deg=10"], KNOWN)
    few_links = {"robot.n_links": 4, "robot.module[7].mass": 1.0}
    with pytest.raises(ValueError, match=r"no `module\[7\]`: modules are 4"):
        change_parameters(SCENARIO, few_links)


@pytest.mark.parametrize(
    ("name", "plain"),
    [
        ("gait.frequency[2]", "gait.frequency"),
        ("robot.module[3].section[0].half_width", "robot.module.section"),
        ("robot[0].module.mass", "robot"),
    ],
)
def test_brackets_after_what_is_one_thing_are_refused(name: str, plain: str):
    with pytest.raises(ValueError, match=rf"; `{plain}` has no brackets"):
        look_up(name, KNOWN)


@pytest.mark.parametrize(
    ("brackets", "items"),
    [("[3]", [3]), ("[:5]", [0, 1, 2, 3, 4]), ("[7:]", range(7, N)), ("[::2]", range(0, N, 2))],
)
def test_a_range_stands_for_the_parts_that_python_means(brackets: str, items: Sequence[int]):
    name = f"robot.module{brackets}.mass"
    changed = change_parameters(SCENARIO, {name: 0.9}).robot
    assert [i for i, module in enumerate(changed.modules) if module.mass == 0.9] == list(items)
    assert value_of(name, replace(SCENARIO, robot=changed)) == 0.9


def test_two_names_of_one_number_are_refused_in_sweeps():
    pairs = (
        ("robot.module.mass", "robot.module[3].mass"),
        ("robot.module[:4].mass", "robot.module[3].mass"),
        ("robot.module[::2].mass", "robot.module[2:].mass"),
    )
    for pair in pairs:
        rule = "`points` must name each number once, got `robot.module"
        with pytest.raises(ValueError, match=rule):
            Sweep(scenario=SCENARIO, points=Grid(values={pair[0]: [0.8], pair[1]: [0.9]}))
        with pytest.raises(ValueError, match="`columns` must name each number once"):
            check_columns(SCENARIO, {pair[0]: [0.8], pair[1]: [0.9]})
    Sweep(
        scenario=SCENARIO,
        points=Grid(values={"robot.module[:4].mass": [0.8], "robot.module[4:].mass": [0.8]}),
    )


def test_of_many_bounds_the_one_out_of_its_range_is_named():
    bounds = {f"robot.module[{i}].length": (0.1, 0.2) for i in range(N)}
    bounds["robot.module[3].mass"] = (-0.8, 0.9)
    rule = r"got robot\.module\[3\]\.mass = -0\.8: mass must be > 0 kg, got -0\.8"
    with pytest.raises(ValueError, match=rule):
        Optimization(scenario=SCENARIO, bounds=bounds, objectives=("forward_velocity",))


def test_options_name_parts_in_units_of_people_or_in_si():
    grid = parse_grid(["robot.module[:5].mass=0.8,0.9", "robot.joint[4].limit-deg=45"], KNOWN)
    assert list(grid.values) == ["robot.module[:5].mass", "robot.joint[4].limit"]
    np.testing.assert_allclose(grid.values["robot.joint[4].limit"], np.radians(45.0))
    ranges = parse_ranges(["robot.module[3].length=0.1:0.2"], KNOWN, RANGE_FORM)
    assert ranges == {"robot.module[3].length": (0.1, 0.2)}
    with pytest.raises(ValueError, match=r"must name a parameter of robot, gait or water, got"):
        parse_grid(["robot.module[40].mass=1"], KNOWN)


def test_numbers_of_parts_are_swept_and_optimized():
    name = "robot.module[:3].length"
    lengths = [0.09, 0.1]
    columns = check_columns(SCENARIO, {name: lengths})
    figures = run_columns(SCENARIO, columns, threads=1, with_peaks=False)[0].figures
    for length, velocity in zip(lengths, figures["forward_velocity"], strict=True):
        alone = lc.swim(change_parameters(SCENARIO, {name: length}))
        assert velocity == pytest.approx(alone.forward_velocity, rel=1e-9)
    bounds = {name: (0.09, 0.1), "robot.joint[4].stiffness": (0.0, 0.2)}
    optimization = Optimization(scenario=SCENARIO, bounds=bounds, objectives=("forward_velocity",))
    assert optimization.names == tuple(bounds)


def test_the_slope_to_a_range_is_the_sum_of_those_to_its_parts():
    names = ["robot.module[:3].mass", *(f"robot.module[{i}].mass" for i in range(3))]
    result = compute_sensitivities([SCENARIO], names=names, figures=["forward_velocity"])
    whole, *parts = result.jacobian[0, 0].tolist()
    assert whole == pytest.approx(sum(parts), rel=1e-9)


# ---- tapers along the body ---------------------------------------------------------------------


def lengths_after(**numbers):
    changes = {f"robot.taper.length.{name}": value for name, value in numbers.items()}
    changed = change_parameters(SCENARIO, changes)
    assert {name: value_of(name, changed) for name in changes} == pytest.approx(changes)
    return np.array([module.length for module in changed.robot.modules])


def test_three_numbers_taper_all_modules():
    before = np.array([module.length for module in SCENARIO.robot.modules])
    along = np.linspace(0.0, 1.0, N)
    np.testing.assert_allclose(
        lengths_after(tail=0.05, head=0.13) - before,
        (0.05 - before[0]) * (1.0 - along) + (0.13 - before[-1]) * along,
        atol=1e-12,
    )
    bulge = value_of("robot.taper.length.bulge", SCENARIO)
    added = lengths_after(bulge=bulge + 0.02) - before
    np.testing.assert_allclose(added, 0.02 * 4.0 * along * (1.0 - along), atol=1e-12)
    assert KNOWN["robot.taper.length.head"].unit == "m"
    assert "robot.taper.length.head" not in set(KNOWN)


def test_a_taper_of_no_quantity_or_number_is_refused_with_the_choices():
    rule = r"a taper is `robot.taper.`, then length or mass or .*, then .tail or head or bulge"
    for name in ("robot.taper.size.head", "robot.taper.mass.nose", "robot.taper.mass"):
        assert name not in KNOWN
        with pytest.raises(ValueError, match=rule):
            look_up(name, KNOWN)
        with pytest.raises(ValueError, match=rule):
            parse_grid([f"{name}=1"], KNOWN)
    with pytest.raises(
        ValueError, match=r"`robot.taper` must be of a quantity .*: `length`, `mass`"
    ):
        change_parameters(SCENARIO, {"robot.taper.size.head": 1.0})
    with pytest.raises(ValueError, match=r"`mass` must be > 0 kg"):
        change_parameters(SCENARIO, {"robot.taper.mass.head": -1.0})


def test_a_taper_shares_its_numbers_with_the_modules():
    check_disjoint(["robot.taper.mass.tail", "robot.taper.mass.head", "robot.taper.length.tail"])
    for other in ("robot.module.mass", "robot.module[3].mass"):
        with pytest.raises(ValueError, match="must name each number once"):
            check_disjoint([other, "robot.taper.mass.tail"])


def test_tapers_are_options_columns_and_slopes():
    options = ["robot.taper.length.head=0.1,0.12", "robot.taper.section.half-width.tail=0.03"]
    grid = parse_grid(options, KNOWN)
    assert list(grid.values) == ["robot.taper.length.head", "robot.taper.section.half_width.tail"]
    bounds = {"robot.taper.length.tail": (0.05, 0.1), "robot.taper.mass.bulge": (-0.1, 0.1)}
    optimization = Optimization(scenario=SCENARIO, bounds=bounds, objectives=("forward_velocity",))
    assert optimization.names == tuple(bounds)
    names = [
        f"robot.taper.{quantity}.{number}"
        for quantity in ("mass", "length", "section.half_width")
        for number in ENDS
    ]
    result = compute_sensitivities([SCENARIO], names=names, figures=["forward_velocity"])
    for column, name in enumerate(names):
        value = value_of(name, SCENARIO)
        step = 1e-4 * max(abs(value), 0.1)
        columns = {name: [value - step, value + step]}
        low, high = swim_many(SCENARIO, columns=columns).forward_velocity
        slope = (high - low) / (2.0 * step)
        assert result.jacobian[0, 0, column] == pytest.approx(slope, rel=1e-6, abs=1e-8), name


# ---- gaits with numbers of their own for every joint --------------------------------------------


def test_joints_of_a_gait_have_names():
    assert KNOWN["gait.amplitude[4]"].phrase == "amplitude of joint 4"
    assert KNOWN["gait.phase[2:]"].phrase == "phase of joints [2:]"
    assert KNOWN["gait.phase[2]"].unit == "rad"
    assert f"gait.phase[{N - 1}]" not in KNOWN
    shares = GAIT.joint_envelope(N)
    assert value_of("gait.amplitude[4]", SCENARIO) == pytest.approx(0.5 * shares[4])
    assert value_of("gait.phase[:5]", SCENARIO) == 0.0


def test_a_joint_gets_the_amplitude_and_the_phase_of_its_name():
    changes = {"gait.amplitude[4]": 0.3, "gait.phase[2]": 0.2, "gait.phase[:2]": -0.1}
    changed = change_parameters(SCENARIO, changes)
    assert {name: value_of(name, changed) for name in changes} == pytest.approx(changes)
    gait = changed.gait
    others = [i for i in range(N - 1) if i != 4]
    shares = np.array(GAIT.joint_envelope(N))
    np.testing.assert_array_equal(np.array(gait.joint_envelope(N))[others], shares[others])
    assert gait.phases == (-0.1, -0.1, 0.2, *[0.0] * (N - 4))
    generator = lc.motion.gaits.Generator(n_links=N, ramp=0.0)
    state = generator.step(generator.init(gait), gait, 1.3)
    angles = generator.joints(state, gait)[0]
    lead = gait.frequency * 1.3 + 2 * gait.phase_shift + 0.2
    assert angles[2] == pytest.approx(gait.amplitude * shares[2] * np.sin(lead))


def test_amplitudes_of_joints_need_a_gait_that_moves():
    still = replace(SCENARIO, motion=replace(GAIT, amplitude=0.0))
    with pytest.raises(ValueError, match=r"`gait\.amplitude` must be > 0 for joints with"):
        change_parameters(still, {"gait.amplitude[4]": 0.3})
    with pytest.raises(ValueError, match="one lead per joint, 9 for 10 links, got 2"):
        replace(GAIT, phases=(0.1, 0.2)).joint_phases(10)


def test_options_name_the_joints_of_a_gait():
    grid = parse_grid(["amplitude[4]-deg=10,20", "gait.phase[:3]-deg=-30"], KNOWN)
    np.testing.assert_allclose(grid.values["gait.amplitude[4]"], np.radians([10.0, 20.0]))
    np.testing.assert_allclose(grid.values["gait.phase[:3]"], np.radians([-30.0]))


LEADS = tuple(0.1 * i for i in range(N - 1))
STEEPER = replace(GAIT, phase_shift=GAIT.phase_shift + 0.1)
LEADING = replace(GAIT, phases=LEADS)


@pytest.mark.parametrize("changes", [{}, {"joints": "pd"}, {"model": "spatial"}])
def test_leads_that_grow_by_a_step_are_another_phase_shift(changes: dict[str, str]):
    steeper, leading = (
        lc.swim("mamba", gait, duration=2.0, **changes)  # pyright: ignore[reportArgumentType]
        for gait in (STEEPER, LEADING)
    )
    np.testing.assert_allclose(leading.joint_angle, steeper.joint_angle, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(leading.center_of_mass, steeper.center_of_mass, atol=1e-9)


def test_the_kernels_follow_the_generator():
    gait = replace(GAIT, phases=tuple(0.3 * (-1) ** i for i in range(N - 1)))
    trial = lc.swim("mamba", gait, duration=2.0)
    generator = lc.motion.gaits.Generator(n_links=N, ramp=0.0)
    state = generator.step(generator.init(gait), gait, 2.0)
    np.testing.assert_allclose(
        trial.joint_angle[-1], generator.joints(state, gait)[0], rtol=0.0, atol=1e-9
    )


def test_trials_side_by_side_are_those_alone():
    gaits = [GAIT, LEADING, replace(GAIT, phases=(0.0,) * (N - 1)), STEEPER]
    figures = swim_many("mamba", gaits, duration=2.0).forward_velocity
    alone = [swim_many("mamba", [gait], duration=2.0).forward_velocity[0] for gait in gaits]
    np.testing.assert_array_equal(figures, alone)
    assert figures[2] == figures[0]


SIXTY = [
    *(f"gait.amplitude[{i}]" for i in range(8)),
    *(f"gait.phase[{i}]" for i in range(8)),
    *(f"robot.module[{i}].length" for i in range(9)),
    *(f"robot.module[{i}].mass" for i in range(9)),
    *(f"robot.module[{i}].section.half_height" for i in range(9)),
    *(f"robot.module[{i}].section.half_width" for i in range(9)),
    *(f"robot.module[{i}].normal_drag" for i in range(6)),
    "gait.frequency",
    "gait.phase_shift",
]
"""Names of a body and a gait with 60 numbers."""


def test_sixty_numbers_of_body_and_gait_are_differentiated_as_differences_say():
    assert len(SIXTY) == 60
    sensitivities = compute_sensitivities([SCENARIO], names=SIXTY, figures=["forward_velocity"])
    slopes = sensitivities.jacobian[0, 0]
    columns: dict[str, list[float]] = {name: [] for name in SIXTY}
    steps = [max(1e-2 * abs(value_of(name, SCENARIO)), 1e-3) for name in SIXTY]
    for i, step in enumerate(steps):
        for share in (1.0, -1.0, 0.5, -0.5):
            for j, name in enumerate(SIXTY):
                change = share * step if j == i else 0.0
                columns[name].append(value_of(name, SCENARIO) + change)
    checked = check_columns(SCENARIO, columns)
    result = run_columns(SCENARIO, checked, threads=1, with_peaks=False)[0]
    velocity = result.figures["forward_velocity"].reshape(len(SIXTY), 4)
    wide = (velocity[:, 0] - velocity[:, 1]) / (2.0 * np.array(steps))
    narrow = (velocity[:, 2] - velocity[:, 3]) / np.array(steps)
    differences = (4.0 * narrow - wide) / 3.0
    np.testing.assert_allclose(slopes, differences, rtol=1e-6, atol=1e-6 * np.abs(slopes).max())


def test_forward_and_backward_agree_at_leads_of_zero():
    few = ["gait.phase[2]", "gait.amplitude[4]", "gait.phase[:]"]
    forward = compute_sensitivities([SCENARIO], names=few, figures=["forward_velocity"])
    backward = compute_sensitivities([SCENARIO], names=SIXTY, figures=["forward_velocity"])
    for name in few[:2]:
        assert forward.of("forward_velocity", name) == pytest.approx(
            backward.of("forward_velocity", name), rel=1e-9
        )
