"""The same run elsewhere: what swims here as a scenario file, what runs it, and buttons that copy both."""

import json
from dataclasses import replace
from html import escape

from laticauda.scenarios import Scenario, run_to_toml

DURATION = 30.0  # [s]
FILE = "scenario.toml"
COMMAND = f"laticauda swim {FILE}"
PYTHON = "trial = lc.swim(scenario)\nprint(trial.forward_velocity, trial.mean_power)"
TEXT = f"""Download it as `{FILE}`, then:
```bash
{COMMAND}
```
```python
import laticauda as lc

scenario = lc.load_scenario("{FILE}")
{PYTHON}
```
What the buttons copy has the file in it."""
"""What a page says of it, as Markdown."""
STYLE = (
    "font:inherit;font-size:0.875em;padding:0.3em 0.8em;margin:0 0.5em 0.3em 0;border:0;border-radius:2px;"
    "background:#1971c2;color:white;cursor:pointer"
)
# Browsers let a page write to the clipboard only if it comes from this computer, or by https; else by the old way.
SCRIPT = (
    "const t={text},b=this,s=b.textContent,done=()=>{{b.textContent='copied';setTimeout(()=>b.textContent=s,1200)}};"
    "if(navigator.clipboard)navigator.clipboard.writeText(t).then(done);"
    "else{{const a=document.createElement('textarea');a.value=t;document.body.append(a);a.select();"
    "document.execCommand('copy');a.remove();done()}}"
)


def scenario_file(scenario: Scenario) -> str:
    """The content of the scenario file: everything that decides the run, for `DURATION`.

    Args:
        scenario: What swims how.
    """
    return run_to_toml(replace(scenario, duration=DURATION))


def in_shell(file: str) -> str:
    """What a shell runs as it is: it writes the file, and runs it.

    Args:
        file: The content of the scenario file.
    """
    return f"cat > {FILE} <<'END'\n{file}END\n{COMMAND}\n"


def in_python(file: str) -> str:
    """A script that runs the scenario without any file; its `trial` is the run.

    Args:
        file: The content of the scenario file.
    """
    imports = "import laticauda as lc\nfrom laticauda.scenarios import run_from_toml"
    return f"{imports}\n\nscenario = run_from_toml(r'''\n{file}''')\n{PYTHON}\n"


def copy_buttons(texts: dict[str, str]) -> str:
    """Buttons, as HTML, that put a text on the clipboard of whoever looks at the page: the server cannot.

    Args:
        texts: What is copied, by what stands on its button.
    """
    return "<div style='padding:0.3em 0.8em'>" + "".join(map(_button, texts, texts.values())) + "</div>"


def _button(label: str, text: str) -> str:
    script = escape(SCRIPT.format(text=json.dumps(text)), quote=True)
    return f'<button type="button" style="{STYLE}" onclick="{script}">{escape(label)}</button>'
