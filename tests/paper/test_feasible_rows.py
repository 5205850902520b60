"""What the docs say of gaits that robots can or cannot do."""

from collections import Counter
from pathlib import Path

import pytest

import laticauda as lc
from laticauda.paper.measured import read_efficiency_trials
from laticauda.robot import load_parameters, robot_names
from laticauda.trials.feasibility import judge_feasibility

PAGE = (Path(__file__).parents[2] / "docs" / "theory" / "joints.md").read_text(encoding="utf-8")
GAITS = (
    lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40),
    lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=90, phase_shift_deg=40),
    lc.eel_like(amplitude_deg=50, frequency_deg_s=110, phase_shift_deg=40),
    lc.eel_like(amplitude_deg=40, frequency_deg_s=90, phase_shift_deg=40),
)


@pytest.mark.parametrize("name", robot_names())
def test_the_docs_say_of_every_preset_whether_it_can_swim_the_gaits_of_the_docs(name: str):
    used = [f"{lc.swim(name, gait, 30.0).utilization:.2f}" for gait in GAITS]
    known = lc.load_robot(name).joints[0].actuator.stated
    assert f"| `{name}`{'' if known else ' (no actuator is stated)'} | {' | '.join(used)} |" in PAGE


@pytest.mark.parametrize("name", ["paper", "mamba-identified", "mamba-textbook"])
def test_the_docs_count_the_gaits_of_table_1_that_are_beyond_the_published_servo(name: str):
    model, rows, beyond, most = load_parameters(name), Counter[bool](), Counter[bool](), 0.0
    for row in read_efficiency_trials():
        published, kind = lc.load_robot(row.robot), row.gait.kind
        robot, water = model.robot(published, kind), model.water(kind)
        trial = lc.swim(robot, row.gait, environment=water, joints=model.joints or "prescribed")
        found = judge_feasibility(published, trial, trial.period)
        rows[row.has_fin] += 1
        beyond[row.has_fin] += bool(found.problems)
        most = max(most, trial.peak_joint_torque)
    (line,) = [
        line for line in PAGE.splitlines() if line.startswith(f"| `{name}` | ") and "N m |" in line
    ]
    counts = [f"{beyond[has_fin]} of {rows[has_fin]}" for has_fin in (False, True)]
    assert line.endswith(f"| {counts[0]} | {counts[1]} | {most:.1f} N m |")
