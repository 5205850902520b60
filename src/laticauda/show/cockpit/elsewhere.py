"""The page's scenario elsewhere: as a file, as a command, and as Python, with buttons that copy them."""

import json
from dataclasses import replace
from html import escape
from pathlib import Path

from laticauda import scenarios

DURATION = 30.0
"""Duration of a run elsewhere [s]."""
FILE = "scenario.toml"
COMMAND = f"laticauda swim {FILE}"
PYTHON = "trial = lc.swim(scenario)\nprint(trial.forward_velocity, trial.mean_power)"


def _read_text() -> str:
    template = Path(__file__).with_suffix(".md").read_text().strip()
    with_command = template.replace("COMMAND", COMMAND)
    return with_command.replace("PYTHON", PYTHON).replace("FILE", FILE)


def _read_script() -> str:
    """Return the script of a button, without the comment in its first two lines."""
    lines = Path(__file__).with_name("copy.js").read_text().splitlines()
    return "".join(lines[2:])


TEXT = _read_text()
"""Explanation on the page, as Markdown."""
BUTTON_STYLE = Path(__file__).with_name("copy.css").read_text().strip()
BUTTON_SCRIPT = _read_script()


def write_scenario(scenario: scenarios.Scenario) -> str:
    """Return the content of the scenario file: everything that determines the run, for `DURATION`.

    Args:
        scenario: The scenario.
    """
    return scenarios.run_to_toml(replace(scenario, duration=DURATION))


def write_shell(file: str) -> str:
    """Return shell commands that write the scenario file and run it.

    Args:
        file: The content of the scenario file.
    """
    return f"cat > {FILE} <<'END'\n{file}END\n{COMMAND}\n"


def write_python(file: str) -> str:
    """Return a script that runs the scenario without any file; its `trial` is the run.

    Args:
        file: The content of the scenario file.
    """
    imports = "import laticauda as lc\nfrom laticauda.scenarios import run_from_toml"
    return f"{imports}\n\nscenario = run_from_toml(r'''\n{file}''')\n{PYTHON}\n"


def build_copy_buttons(texts: dict[str, str]) -> str:
    """Return buttons, as HTML, that copy a text to the clipboard of the page's user, which the server cannot do.

    Args:
        texts: Texts to copy, by the labels of their buttons.
    """
    buttons = [_build_copy_button(label, text) for label, text in texts.items()]
    return f"<div style='padding:0.3em 0.8em'>{''.join(buttons)}</div>"


def _build_copy_button(label: str, text: str) -> str:
    script = escape(BUTTON_SCRIPT.format(text=json.dumps(text)), quote=True)
    attributes = f'type="button" style="{BUTTON_STYLE}" onclick="{script}"'
    return f"<button {attributes}>{escape(label)}</button>"
