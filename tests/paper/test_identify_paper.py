"""A slice of campaigns/identify_paper.py, and the preset that came out of it."""

from dataclasses import fields
from typing import Any

import numpy as np
import pytest
from campaign_scripts import campaign

import laticauda as lc
from laticauda.paper.measured import efficiency_trials
from laticauda.trial.null_models import mape

paper: Any = campaign("identify_paper")
CHOSEN = next(one for one in paper.CANDIDATES if one.name == "geared, U, gain")
PRESET = lc.load_parameters("mamba-identified")


def table_1_speeds() -> np.ndarray:
    robots = [PRESET.robot(lc.load_robot("mamba-fin" if row.has_fin else "mamba"), row.gait.kind) for row in paper.ROWS]
    waters = [PRESET.water(row.gait.kind) for row in paper.ROWS]
    gaits = [row.gait for row in paper.ROWS]
    assert PRESET.joints is not None
    return lc.swim_many(robots, gaits, environments=waters, joints=PRESET.joints).forward_velocity


def test_the_preset_has_the_error_on_table_1_that_the_docs_state():
    speeds = table_1_speeds()
    assert mape(paper.MEASURED, speeds) == pytest.approx(5.9, abs=0.1)
    groups = [mape(paper.MEASURED[paper.GROUP == g], speeds[paper.GROUP == g]) for g in range(4)]
    assert groups == pytest.approx([4.1, 6.1, 6.7, 6.3], abs=0.2)


def test_the_preset_is_the_candidate_that_was_chosen():
    values = {
        "water.tangential_friction": PRESET.water("eel_like").tangential_friction,
        "water.drag.reference_speed": PRESET.water("eel_like").drag.reference_speed,
        "geared.no_load_speed": 0.590,
        "robot.joint.actuator.servo_gain": 3.67,
    }
    model = CHOSEN.model(values)
    for has_fin, name in ((False, "mamba"), (True, "mamba-fin")):
        ours = PRESET.robot(lc.load_robot(name), "eel_like")
        actuator, other = ours.joints[0].actuator, model.robots[has_fin].joints[0].actuator
        assert [getattr(actuator, one.name) for one in fields(actuator)] == pytest.approx(
            [getattr(other, one.name) for one in fields(other)], rel=1e-3
        )
        assert ours.caudal_fin == model.robots[has_fin].caudal_fin


def test_a_step_of_the_fit_does_not_leave_the_numbers_of_the_preset():
    values = {
        "water.tangential_friction": 0.136,
        "geared.no_load_speed": 0.590,
        "water.drag.reference_speed": 0.130,
        "robot.joint.actuator.servo_gain": 3.67,
    }
    every = np.ones(len(paper.ROWS), dtype=bool)
    assert paper.fitted(CHOSEN, every, start=values, most=2).values == pytest.approx(values, rel=0.03)


def test_the_campaign_fits_the_measured_rows_of_table_1_only():
    assert len(paper.ROWS) == 20
    assert set(paper.ROWS) <= set(efficiency_trials())


def test_the_rule_takes_the_motor_among_equals_and_leaves_out_what_it_must():
    def result(name: str, group: float, one: float, **more: Any) -> dict[str, Any]:
        usual = {"n": 4, "at_an_end": False, "is_limit": False, "is_motor": False}
        return {"name": name, "leave_one_group_out": group, "leave_one_out": one, **usual, **more}

    shrunken, motor = result("shrunken", 8.1, 7.2), result("motor", 8.9, 7.4, is_motor=True)
    others = [
        result("five numbers", 1.0, 1.0, n=5),
        result("at an end", 1.0, 1.0, at_an_end=True),
        result("no motor is like that", 1.0, 1.0, is_limit=True, is_motor=True),
        result("a motor that generalizes badly", 9.2, 5.0, is_motor=True),
    ]
    assert paper.chosen([shrunken, motor, *others])["name"] == "motor"
    assert paper.chosen([shrunken, *others[:3]])["name"] == "shrunken"
    smaller = result("smaller", 8.9, 7.5, is_motor=True, n=3)
    assert paper.chosen([shrunken, motor, smaller])["name"] == "smaller"


def test_the_preset_of_speed_limited_joints_has_the_error_that_the_docs_state():
    found = lc.load_parameters("mamba-speed-limited")
    assert found.joints == "servo"
    speeds = lc.swim_many(
        [found.robot(lc.load_robot("mamba-fin" if row.has_fin else "mamba"), row.gait.kind) for row in paper.ROWS],
        [row.gait for row in paper.ROWS],
        environments=found.water("eel_like"),
        joints=found.joints,
    ).forward_velocity
    assert mape(paper.MEASURED, speeds) == pytest.approx(6.1, abs=0.1)
