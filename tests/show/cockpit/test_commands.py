import json
import math
import re
import shlex
import subprocess
from dataclasses import replace
from html import escape
from types import SimpleNamespace

import pytest
from cockpit_browser import browser

import laticauda as lc
from laticauda.cli import main
from laticauda.control import StraightLine
from laticauda.motion.gaits import Custom, EelLike, Wave
from laticauda.scenarios import run_to_toml
from laticauda.show.cockpit import Cockpit, Live, read_figures
from laticauda.show.cockpit.changes import adapt_scenario, change_fin
from laticauda.show.cockpit.elsewhere import (
    FILE,
    TEXT,
    build_copy_buttons,
    write_python,
    write_shell,
)

GAIT = lc.lateral_undulation(
    amplitude=math.radians(31.0), frequency=math.radians(125.0), phase_shift=math.radians(40.0)
)
PITCH = Wave(
    amplitude=0.1, frequency=GAIT.frequency, phase_shift=GAIT.phase_shift, phase=0.5 * math.pi
)
DURATION = 6.0
SCENARIOS = [
    lc.build_scenario("mamba", GAIT),
    lc.build_scenario("mamba-fin", replace(GAIT, envelope=EelLike(), offset=0.05), joints="pd"),
    adapt_scenario(lc.build_scenario("mamba", GAIT), current=(0.1, -0.02)),
    adapt_scenario(
        lc.build_scenario("mamba", GAIT), path=StraightLine(point=(0.5, -0.6), angle=0.2)
    ),
    lc.build_scenario(change_fin(lc.load_robot("mamba"), True, 0.3), GAIT, joints="servo"),
    lc.build_scenario(
        "mamba", GAIT, environment=replace(lc.load_water("paper-lateral"), normal_drag=1.4)
    ),
    lc.build_scenario("mamba", GAIT, environment="paper-eel"),
    lc.build_scenario("mamba", replace(GAIT, envelope=Custom(values=(1.0,) * 4 + (0.5,) * 4))),
    lc.build_scenario("mamba-modules", replace(GAIT, pitch=PITCH), model="spatial"),
]


class Page:
    """Stands for a browser's page: keeps the files that it is sent."""

    def __init__(self):
        self.files = {}

    _websock_connection = SimpleNamespace(
        get_message_buffer=lambda: SimpleNamespace(message_from_id={})
    )

    def send_file_download(self, name, content, **settings):
        self.files[name] = content


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_the_file_the_command_and_the_python_run_as_they_are_and_give_the_numbers_of_the_page(
    scenario, capsys, tmp_path, monkeypatch
):
    pytest.importorskip("viser")
    if isinstance(scenario.model, lc.Spatial):
        pytest.importorskip("mujoco")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("laticauda.show.cockpit.elsewhere.DURATION", DURATION)
    live = Live(scenario)
    cockpit, page = Cockpit(live, port=0), Page()
    try:
        cockpit._runs._send_scenario(SimpleNamespace(client=page))
        copied = cockpit._runs._copy.content
    finally:
        cockpit.close()
    (tmp_path / FILE).write_bytes(page.files[FILE])
    command, code = re.findall(r"```(?:bash|python)\n(.*?)\n```", TEXT, re.DOTALL)
    words = shlex.split(command)
    assert words[0] == "laticauda"
    assert main([*words[1:], "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    scope = {}
    exec(code, scope)
    trial = scope["trial"]
    assert scope["scenario"] == replace(scenario, duration=DURATION)
    assert (printed["forward_velocity"], printed["mean_power"]) == (
        trial.forward_velocity,
        trial.mean_power,
    )
    for text in (write_shell, write_python):
        assert escape(json.dumps(text(page.files[FILE].decode())), quote=True) in copied
    for _ in range(round(DURATION / 0.1)):
        live.advance(0.1)
    assert read_figures(live)["time"] == pytest.approx(DURATION)
    assert read_figures(live)["forward_velocity"] == pytest.approx(trial.forward_velocity, rel=1e-3)
    # The page steps by half as much: that matters to the work of the first moments, when a path
    # begins with a jerk.
    assert read_figures(live)["mean_power"] == pytest.approx(trial.mean_power, rel=3e-3)


def test_what_is_copied_has_the_file_in_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    robot = replace(lc.load_robot("mamba"), name='it\'s \\ "mine"')
    scenario = lc.build_scenario(robot, GAIT, 0.1)
    scope = {}
    exec(write_python(run_to_toml(scenario)), scope)
    assert scope["scenario"] == scenario
    shell = write_shell(run_to_toml(scenario)).replace("laticauda swim", "test -f")
    subprocess.run(["bash", "-e", "-c", shell], check=True)
    assert lc.load_scenario(FILE) == scenario


# ---- buttons that copy them ----------------------------------------------------------------------

TEXTS = {"copy <this>": 'first "line" \\\n  --it\'s {one} & more', "copy that": f"{math.pi}"}


@pytest.fixture(scope="module")
def chromium():
    with browser() as found:
        yield found


def test_a_button_puts_its_text_on_the_clipboard_as_it_is(chromium, tmp_path):
    (tmp_path / "page.html").write_text(
        f"<!doctype html><body>{build_copy_buttons(TEXTS)}</body>", encoding="utf-8"
    )
    page = chromium.new_context().new_page()
    # What the browser is asked to copy, in place of the clipboard, which a test must not
    # overwrite.
    kept = "Object.defineProperty(navigator, 'clipboard', {value: {writeText: async t => {window.kept = t}}})"
    page.add_init_script(kept)
    page.goto((tmp_path / "page.html").as_uri())
    for label, text in TEXTS.items():
        page.get_by_role("button", name=label).click()
        assert page.evaluate("window.kept") == text


def test_where_the_browser_allows_no_clipboard_the_old_way_is_taken(chromium, tmp_path):
    (tmp_path / "page.html").write_text(
        f"<!doctype html><body>{build_copy_buttons(TEXTS)}</body>", encoding="utf-8"
    )
    page = chromium.new_context().new_page()
    page.add_init_script(
        "Object.defineProperty(navigator, 'clipboard', {value: undefined});"
        "document.execCommand = () => {window.kept = document.activeElement.value}"
    )
    page.goto((tmp_path / "page.html").as_uri())
    page.get_by_role("button", name="copy that").click()
    assert page.evaluate("window.kept") == TEXTS["copy that"]
    assert page.locator("textarea").count() == 0
