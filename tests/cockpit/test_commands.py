import json
import math
import re
import shlex
from dataclasses import replace
from types import SimpleNamespace

import pytest

import laticauda as lc
from laticauda.cli import main
from laticauda.cockpit import Cockpit, Live, Setting
from laticauda.cockpit.commands import FILE, WATER_FILE, commands_text, robot_source
from laticauda.cockpit.settings import with_fin
from laticauda.control import StraightLine
from laticauda.gaits import Wave

GAIT = lc.lateral_undulation(
    amplitude=math.radians(31.0), frequency=math.radians(125.0), phase_shift=math.radians(40.0)
)
PITCH = Wave(amplitude=0.1, frequency=GAIT.frequency, phase_shift=GAIT.phase_shift, phase=0.5 * math.pi)
DURATION = 6.0
SETTINGS = [
    Setting(robot=lc.load_robot("mamba"), gait=GAIT),
    Setting(robot=lc.load_robot("mamba-fin"), gait=replace(GAIT, kind="eel_like", offset=0.05), joints="pd"),
    Setting(robot=lc.load_robot("mamba"), gait=GAIT, current=(0.1, -0.02)),
    Setting(robot=lc.load_robot("mamba"), gait=GAIT, path=StraightLine(point=(0.5, -0.6), angle=0.2)),
    Setting(robot=with_fin(lc.load_robot("mamba"), True, 0.3), gait=GAIT, joints="servo"),
    Setting(robot=lc.load_robot("mamba"), gait=GAIT, water=replace(lc.load_water("paper-lateral"), normal_drag=1.4)),
    Setting(robot=lc.load_robot("mamba"), gait=GAIT, water=lc.load_water("paper-eel")),
    Setting(robot=lc.load_robot("mamba"), gait=replace(GAIT, kind="custom", envelope=(1.0,) * 4 + (0.5,) * 4)),
    Setting(robot=lc.load_robot("mamba-modules"), gait=replace(GAIT, pitch=PITCH), model="spatial"),
]


class Page:
    """Stands for a browser's page: keeps the files that it is sent."""

    def __init__(self):
        self.files = {}

    def send_file_download(self, name, content, **settings):
        self.files[name] = content


@pytest.mark.parametrize("setting", SETTINGS)
def test_the_copied_command_line_and_python_run_as_they_are_and_give_the_numbers_of_the_page(
    setting, capsys, tmp_path, monkeypatch
):
    pytest.importorskip("viser")
    if setting.model == "spatial":
        pytest.importorskip("mujoco")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("laticauda.cockpit.commands.DURATION", DURATION)
    live = Live(setting)
    cockpit, page = Cockpit(live, port=0), Page()
    try:
        cockpit._runs._send_robot(SimpleNamespace(client=page))
        cockpit._runs._send_water(SimpleNamespace(client=page))
        shown = cockpit._runs._text.content
    finally:
        cockpit.close()
    for name, content in page.files.items():
        (tmp_path / name).write_bytes(content)
    command, code = re.findall(r"```(?:bash|python)\n(.*?)\n```", shown, re.DOTALL)
    words = shlex.split(command.replace("\\\n", " "))
    assert words[0] == "laticauda"
    assert main([*words[1:], "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    scope = {}
    exec(code, scope)
    trial = scope["trial"]
    assert trial.environment == setting.environment
    assert trial.robot == (setting.robot if setting.model == "spatial" else setting.robot.planar())
    assert printed["forward_velocity"] == pytest.approx(trial.forward_velocity, rel=1e-4)
    assert printed["mean_power"] == pytest.approx(trial.mean_power, rel=1e-4)
    for _ in range(round(DURATION / 0.1)):
        live.advance(0.1)
    assert live.numbers().time == pytest.approx(DURATION)
    assert live.numbers().forward_velocity == pytest.approx(trial.forward_velocity, rel=1e-3)
    # The page steps by half as much: that matters to the work of the first moments, when a path begins with a jerk.
    assert live.numbers().mean_power == pytest.approx(trial.mean_power, rel=3e-3)


def test_a_robot_that_is_no_preset_comes_from_a_file():
    robot = with_fin(lc.load_robot("mamba"), True, 0.3)
    assert robot_source(robot) == FILE
    text = commands_text(Setting(robot=robot, gait=GAIT))
    assert f"download it as `{FILE}` first" in text
    assert f"--robot {FILE}" in text


def test_a_water_that_is_no_preset_comes_from_a_file_too():
    water = replace(lc.load_water("paper-lateral"), normal_drag=1.4)
    text = commands_text(Setting(robot=lc.load_robot("mamba"), gait=GAIT, water=water))
    assert f"download it as `{WATER_FILE}` first" in text
    assert "--water paper-lateral" in commands_text(
        Setting(robot=lc.load_robot("mamba"), gait=GAIT, water=lc.load_water("paper-lateral"))
    )
