"""A slice of campaigns/identify_paper.py, and the presets that came out of it."""

import csv
import sys
from typing import Any

import numpy as np
import pytest
from campaign_scripts import FOLDER, campaign

import laticauda as lc
from laticauda.paper.measured import read_efficiency_trials
from laticauda.trials.null_models import mape

sys.modules["amphibot"] = campaign("amphibot")  # as the script finds it beside itself
paper: Any = campaign("identify_paper")
IDENTIFIED = "beta 1, relative, geared speed-servo, drag on the body"
SHARED = "beta 0.5, kirchhoff, geared speed-servo, drag on the body"
PRESETS = {"mamba-identified": IDENTIFIED, "mamba-textbook": SHARED}
CANDIDATES = {candidate.name: candidate for candidate in paper.CANDIDATES}


def model_of(name: str) -> Any:
    """The preset as the campaign has its models."""
    parameters = lc.load_parameters(name)
    robots = {
        False: parameters.robot(lc.load_robot("mamba"), "eel_like"),
        True: parameters.robot(lc.load_robot("mamba-fin"), "eel_like"),
    }
    return paper.Model(robots=robots, water=parameters.every_gait, joints=parameters.joints)


def numbers_of(name: str) -> tuple[float, float]:
    parameters: Any = lc.load_parameters(name)
    return parameters.every_gait.tangential_friction, parameters.joints.speed_limit


@pytest.mark.parametrize(("name", "error"), [("mamba-identified", 5.0), ("mamba-textbook", 7.2)])
def test_a_preset_has_the_error_on_table_1_that_the_docs_state(name: str, error: float):
    assert mape(paper.MEASURED, paper.forward_velocities([model_of(name)])[0]) == pytest.approx(
        error, abs=0.06
    )


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_is_the_candidate_that_was_chosen(name: str):
    ours, theirs = model_of(name), CANDIDATES[PRESETS[name]].model(numbers_of(name))
    speeds = paper.forward_velocities([ours, theirs])
    assert speeds[0] == pytest.approx(speeds[1], rel=2e-3)
    for has_fin in (False, True):
        assert ours.robots[has_fin].caudal_fin == theirs.robots[has_fin].caudal_fin
        assert ours.robots[has_fin].tether == theirs.robots[has_fin].tether


def test_the_campaign_fits_the_measured_rows_of_table_1_only():
    assert len(paper.ROWS) == 20
    assert set(paper.ROWS) <= set(read_efficiency_trials())


def test_every_candidate_has_two_numbers_and_none_of_them_moves_what_is_fixed():
    assert len(CANDIDATES) == len(paper.CANDIDATES) == 72
    one = CANDIDATES[IDENTIFIED]
    slow, fast = one.model((0.1, 0.5)), one.model((0.2, 1.0))
    for has_fin in (False, True):
        still, changed = slow.robots[has_fin], fast.robots[has_fin]
        assert (still.modules, still.caudal_fin) == (changed.modules, changed.caudal_fin)
        motors = [robot.joints[0].actuator for robot in (still, changed)]
        powers = [motor.stall_torque * motor.no_load_speed for motor in motors]
        assert powers[0] == pytest.approx(powers[1])  # a gear keeps the power of the motor
    assert slow.joints.position_gain / slow.joints.speed_limit == pytest.approx(
        fast.joints.position_gain
    )


def test_the_rule_takes_the_other_robot_among_equals_and_leaves_out_what_is_at_an_end():
    def result(name: str, group: float, swims: float, **more: Any) -> dict[str, Any]:
        amphibot = {"swim 1": -swims, "swim 2": swims}
        return {"name": name, "by_groups": group, "amphibot": amphibot, "at_an_end": False, **more}

    choices = paper.choose(
        [
            result("at an end", 1.0, 0.0, at_an_end=True),
            result("best here", 5.0, 0.3),
            result("as good", 5.4, 0.2),
            result("a compromise", 8.0, 0.05),
            result("best there", 12.0, 0.01),
        ]
    )
    names = {choice: result["name"] for choice, result in choices.items()}
    assert names == {
        "Mamba's": "as good",
        "shared": "a compromise",
        "by Mamba alone": "best here",
        "by AmphiBot alone": "best there",
    }


def test_the_interval_of_table_1_that_was_written_beforehand_holds_what_was_measured():
    with (FOLDER / "identify_paper_interval.csv").open() as file:
        rows = [
            {name: float(cell) for name, cell in row.items() if name != "gait"}
            for row in csv.DictReader(file)
        ]
    assert len(rows) == len(paper.ROWS)
    for row, measured in zip(rows, paper.ROWS, strict=True):
        assert row["alpha_deg"] == pytest.approx(np.degrees(measured.gait.amplitude))
        assert row["low_m_s"] < measured.forward_velocity < row["high_m_s"]
