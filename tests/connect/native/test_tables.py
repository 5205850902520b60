import math
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import laticauda as lc
from laticauda.connect.native import entry
from laticauda.connect.native.c_tables import write_c_tables
from laticauda.connect.native.tables import Tables, build_tables
from laticauda.models.planar.layout import build_layout
from laticauda.models.simulate import build_plant
from laticauda.robot import Water
from laticauda.scenarios.interfaces import Start

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
COEFFICIENTS = (
    "tangential_friction",
    "normal_drag",
    "added_mass",
    "added_inertia",
    "tangential_added_mass",
)
POSITIVE = st.just(0.0) | st.floats(1e-9, 5.0)  # of smaller ones, a product may have no digits


def tables(water: Water, robot: str = "mamba-fin", **settings: str) -> Tables:
    return build_tables(
        build_plant(lc.load_robot(robot), water, **settings), GAIT, Start(), inputs="gait"
    )


def test_leads_of_joints_are_parameters_of_a_gait_that_has_some():
    plant = build_plant(lc.load_robot("mamba"), lc.load_water("paper-lateral"))
    leads = tuple(0.1 * i for i in range(8))
    for gait, expected in ((GAIT, {}), (replace(GAIT, phases=leads), dict(enumerate(leads)))):
        told = build_tables(plant, gait, Start(), inputs="gait")
        starts = {variable.name: variable.start for variable in told.variables}
        found = {name: start for name, start in starts.items() if name.startswith("gait.phase[")}
        assert found == {f"gait.phase[{i}]": lead for i, lead in expected.items()}


def rows_in(told: Tables, water: Water) -> np.ndarray:
    """The rows that the compiled function begins with, for another water."""
    whole, real = told.whole, told.real
    template = real[: told.n_rows].copy()
    values = np.array([v.start for v in told.variables])
    for i, variable in enumerate(told.variables):
        if variable.coefficient:
            values[i] = getattr(water, variable.coefficient)
    terms, at, n = whole[entry.TERMS : entry.TERMS + 3]
    pairs = whole[terms : terms + 2 * n].reshape(n, 2)
    now = np.array([values[d] * (1.0 if c == entry.NONE else values[c]) for c, d in pairs])
    change = now - real[at : at + n]
    where, factors, count = whole[entry.SLOPES : entry.SLOPES + 3]
    for (term, row), slope in zip(
        whole[where : where + 2 * count].reshape(count, 2),
        real[factors : factors + count],
        strict=True,
    ):
        template[row] += slope * change[term]
    return template


@pytest.mark.parametrize(
    ("form", "trailing"),
    [
        ("relative", "none"),
        ("kirchhoff", "elongated"),
        ("kirchhoff", "finite-span"),
        ("classic", "none"),
    ],
)
@pytest.mark.parametrize("rotational", ["paper", "strip"])
@settings(max_examples=10)
@given(
    density=st.floats(1.0, 2000.0),
    coefficients=st.tuples(*[POSITIVE] * 5),
    taper=st.floats(-1.0, 1.0),
)
def test_rows_of_another_water_are_those_of_its_own_layout(
    form, trailing, rotational, density, coefficients, taper
):
    here = replace(
        lc.load_water("paper-eel"),
        added_mass_form=form,
        rotational=rotational,
        trailing_edge=trailing,
        friction_taper=taper,
    )
    there = replace(here, density=density, **dict(zip(COEFFICIENTS, coefficients, strict=True)))
    robot = lc.load_robot("mamba-fin")
    expected = build_layout(robot, there).template
    found = rows_in(tables(here), there)
    parameters = expected != 0.0  # the rest are state and what the gait writes
    scale = np.maximum(np.abs(expected), np.abs(build_layout(robot, here).template))[parameters]
    gait = np.isin(np.flatnonzero(parameters), np.flatnonzero(rows_of_others(here)))
    assert np.all((np.abs(found - expected)[parameters] <= 1e-11 * scale) | gait)


def rows_of_others(water: Water) -> np.ndarray:
    """Rows that do not come from the layout alone: bandwidth, envelope and so on."""
    return (
        tables(water).real[: build_layout(lc.load_robot("mamba-fin"), water).template.size]
        != build_layout(lc.load_robot("mamba-fin"), water).template
    )


def test_modules_with_coefficients_of_their_own_do_not_follow_the_waters():
    water = lc.load_water("paper-lateral")
    robot = lc.load_robot("mamba")
    own = replace(
        robot, modules=tuple(replace(module, normal_drag=1.0) for module in robot.modules)
    )
    told = build_tables(build_plant(own, water), GAIT, Start(), inputs="gait")
    there = replace(water, normal_drag=3.0)
    assert rows_in(told, there) == pytest.approx(told.real[: told.n_rows], abs=0.0)


def test_every_number_of_the_water_is_a_variable_or_told_as_fixed():
    from laticauda.connect.fmu.documentation import list_fixed_settings

    water = lc.load_water("paper-lateral")
    names = {v.name.removeprefix("water.") for v in tables(water).variables} | {"current", "name"}
    told = " ".join(setting.name for setting in list_fixed_settings(tables(water)))
    missing = [field.name for field in fields(Water) if field.name not in names]
    spoken = {
        "drag": "drag",
        "friction_taper": "friction taper",
        "plate_drag": "plate drag",
        "plate_added_mass": "plate added mass",
        "edge_clip": "edge clip",
        "added_mass_form": "form of the added mass",
        "rotational": "rotational loads",
        "trailing_edge": "trailing edge",
        "depth": "depth",
    }
    assert [name for name in missing if spoken[name] not in told] == []


def test_numbers_reach_c_to_the_last_bit():
    told = tables(lc.load_water("paper-lateral"))
    (line,) = [line for line in write_c_tables(told, "{}").splitlines() if " real[]" in line]
    numbers = line[line.index("{") + 1 : line.index("}")].split(", ")
    assert [float.fromhex(number) for number in numbers] == told.real.tolist()


def test_names_are_told_apart_and_values_lie_in_their_ranges():
    for joints in ("prescribed", "pd", "servo"):
        variables = tables(lc.load_water("paper-lateral"), joints=joints).variables
        assert len({v.name for v in variables}) == len(variables)
        assert all(v.least <= v.start <= v.most and math.isfinite(v.start) for v in variables)
        assert all(v.description.endswith(".") for v in variables)
