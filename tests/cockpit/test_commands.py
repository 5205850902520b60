import json
import math
import shlex
from dataclasses import replace

import pytest

import laticauda as lc
from laticauda.cli import main
from laticauda.cockpit import Setting
from laticauda.cockpit.commands import FILE, command_line, commands_text, python_code, robot_source
from laticauda.cockpit.settings import with_fin
from laticauda.control import StraightLine

GAIT = lc.lateral_undulation(
    amplitude=math.radians(31.0), frequency=math.radians(125.0), phase_shift=math.radians(40.0)
)
SETTINGS = [
    Setting(robot=lc.load_robot("mamba"), gait=GAIT),
    Setting(robot=lc.load_robot("mamba-fin"), gait=replace(GAIT, kind="eel_like", offset=0.05), joints="pd"),
    Setting(robot=lc.load_robot("mamba"), gait=GAIT, current=(0.1, -0.02)),
    Setting(robot=lc.load_robot("mamba"), gait=GAIT, path=StraightLine(point=(0.5, -0.6), angle=0.2)),
]


@pytest.mark.parametrize("setting", SETTINGS)
def test_command_line_and_python_are_the_same_run(setting, capsys):
    assert main([*shlex.split(command_line(setting))[1:], "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    scope = {}
    exec(python_code(setting), scope)
    trial = scope["trial"]
    assert trial.environment == setting.environment
    assert trial.robot == setting.robot
    assert printed["forward_velocity"] == pytest.approx(trial.forward_velocity, rel=1e-4)
    assert printed["mean_power"] == pytest.approx(trial.mean_power, rel=1e-4)


def test_a_robot_that_is_no_preset_comes_from_a_file():
    robot = with_fin(lc.load_robot("mamba"), True, 0.3)
    assert robot_source(robot) == FILE
    text = commands_text(Setting(robot=robot, gait=GAIT))
    assert f"download it as `{FILE}` first" in text
    assert f"--robot {FILE}" in text
