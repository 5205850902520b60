"""Names of single parts and of ranges: one reader for sweeps, optimization, identification and options."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.cli.vary import RANGE_FORM, parse_grid, parse_ranges
from laticauda.models.simulate import compute_sensitivities, list_parameters
from laticauda.models.simulate.numbers import change_parameters, look_up, value_of
from laticauda.models.simulate.run_table import check_columns
from laticauda.models.simulate.table_run import run_columns
from laticauda.studies import Grid, Optimization, Sweep

GAIT = lc.eel_like(amplitude=0.5, frequency=6.0, phase_shift=0.7)
SCENARIO = lc.build_scenario("mamba", GAIT, duration=2.0)
KNOWN = list_parameters(SCENARIO)
N = SCENARIO.robot.n_links


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
    rule = r"items of `robot.module.mass` count from 0 at the tail, such as \[3\] or \[:5\]"
    with pytest.raises(ValueError, match=rule):
        look_up(f"robot.module[{N}].mass", KNOWN)
    few_links = {"robot.n_links": 4, "robot.module[7].mass": 1.0}
    with pytest.raises(ValueError, match=r"no `module\[7\]`: modules are 4"):
        change_parameters(SCENARIO, few_links)


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
