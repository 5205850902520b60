"""Numbers of modules and joints as parameters of the compiled function, beside layouts of robots that have them."""

import ctypes
import math
import shutil
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import laticauda as lc
from laticauda.connect import export_c
from laticauda.connect.native.tables import build_tables_of_scenario
from laticauda.models.planar import rows
from laticauda.models.simulate.numbers import change_parameters
from laticauda.robot import DragArea, PectoralFin, Thruster

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
needs_cc = pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")


def scenario_of(case: str) -> lc.Scenario:
    """Robots and waters in which a module's numbers enter in different ways."""
    water = lc.load_water("paper-lateral")
    robot = lc.load_robot("mamba-fin" if case == "rigid fin" else "mamba")
    if case == "strips and wake":
        water = replace(
            water,
            rotational="strip",
            added_mass_form="kirchhoff",
            trailing_edge="elongated",
            depth=0.5,
        )
    if case == "classic, own coefficients and inertia":
        water = replace(water, added_mass_form="classic", tangential_added_mass=0.3)
        own: Any = {"normal_drag": 1.1, "inertia": 2e-3, "added_mass": 0.7}
        robot = replace(robot, modules=tuple(replace(m, **own) for m in robot.modules))
    if case == "taper":
        water = replace(water, friction_taper=0.4)
    if case == "effectors":
        robot = replace(
            robot,
            thrusters=(Thruster(link=2, thrust=1.5, angle=0.4, x=0.02, y=0.03),),
            pectoral_fins=(
                PectoralFin(link=4, area=0.01, x=0.01, lift_slope=3.0, stall_angle=0.3),
            ),
            drag_areas=(DragArea(link=0, along=1e-3, across=2e-3, x=0.01),),
        )
    return lc.build_scenario(robot, GAIT, environment=water, joints="pd")


CASES = (
    "plain",
    "rigid fin",
    "strips and wake",
    "classic, own coefficients and inertia",
    "taper",
    "effectors",
)


class Library(NamedTuple):
    """A compiled robot: its variables, and behind them the rows of the kernels."""

    functions: Any
    names: list[str]
    n_rows: int

    def rows_after(self, values: Mapping[str, float], steps: int = 0) -> np.ndarray:
        """Return all rows after that many steps of 50 ms from a start with these parameters."""
        numbers = (ctypes.c_double * (len(self.names) + self.n_rows + 2))()
        self.functions.snake_reset(numbers)
        for name, value in values.items():
            numbers[self.names.index(name)] = value
        assert self.functions.snake_begin(numbers) == 0
        for _ in range(steps):
            assert self.functions.snake_step(numbers, ctypes.c_double(0.05)) == 0
        first = len(self.names)
        return np.array(numbers[first : first + self.n_rows])


@cache
def library_of(case: str) -> Library:
    with TemporaryDirectory() as folder:
        variables = export_c(Path(folder) / "snake.h", scenario_of(case))
        functions = ctypes.CDLL(str(Path(folder) / "libsnake.so"))
    tables = build_tables_of_scenario(scenario_of(case))
    return Library(functions, [variable.name for variable in variables], tables.n_rows)


def parameters_of(case: str) -> list[str]:
    names = library_of(case).names
    return [name for name in names if name.startswith(("robot.module[", "robot.joint["))]


def expected_rows(case: str, values: Mapping[str, float]) -> np.ndarray:
    """Return the rows with which a robot laid out with these numbers begins."""
    tables = build_tables_of_scenario(change_parameters(scenario_of(case), values))
    return tables.real[: tables.n_rows]


@needs_cc
@pytest.mark.parametrize("case", CASES)
@settings(max_examples=8)
@given(data=st.data())
def test_rows_of_a_changed_body_are_those_of_its_own_layout(case, data):
    names = data.draw(st.sets(st.sampled_from(parameters_of(case)), min_size=1, max_size=12))
    factors = st.floats(0.7, 1.4)
    values: dict[str, float] = {}
    variables = build_tables_of_scenario(scenario_of(case)).variables
    for name in sorted(names):
        (start,) = [variable.start for variable in variables if variable.name == name]
        values[name] = start * data.draw(factors)
        if name.endswith(("center", "stiffness", "damping")):
            values[name] = 0.01 * data.draw(factors)
    found = library_of(case).rows_after(values)
    expected = expected_rows(case, values)
    unchanged = expected_rows(case, {})
    scale = np.maximum(np.abs(expected), np.abs(unchanged))
    laid_out = unchanged != 0.0  # the rest is scratch of the begin, or never written
    assert np.all((np.abs(found - expected) <= 1e-12 * scale)[laid_out])


@needs_cc
@pytest.mark.parametrize("case", CASES)
def test_every_number_of_a_module_reaches_the_motion_as_in_python(case):
    values: dict[str, float] = {}
    variables = build_tables_of_scenario(scenario_of(case)).variables
    for variable in variables:
        if variable.name.startswith("robot.module[") and not variable.name.endswith("center"):
            values[variable.name] = variable.start * (1.0 + 0.01 * (len(values) % 7))
    assert values
    library = library_of(case)
    found = library.rows_after(values, steps=40)
    scenario = replace(change_parameters(scenario_of(case), values), duration=2.0)
    trial = lc.swim(scenario)
    np.testing.assert_allclose(found[[rows.X, rows.Y]], trial.center_of_mass[-1], atol=1e-10)
    moved = library.rows_after({}, steps=40)
    assert math.dist(moved[[rows.X, rows.Y]], found[[rows.X, rows.Y]]) > 1e-5
