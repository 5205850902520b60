"""The examples run, are short, and are shown in the docs."""

import os
import runpy
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from laticauda.values.extensions import Extensible

ROOT = Path(__file__).parent.parent
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.stem)
def test_the_example_runs(example: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """In this process, which has loaded all they need; LATICAUDA_EXAMPLES=alone gives each one of its own."""
    if os.environ.get("LATICAUDA_EXAMPLES") != "alone":
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", [str(example)])
        monkeypatch.syspath_prepend(ROOT / "plugins/laticauda-gym/src")
        known = {base: dict(base._members) for base in Extensible.__subclasses__()}
        try:
            runpy.run_path(str(example), run_name="__main__")
        finally:
            plt.close("all")
            for base, names in known.items():  # laws of one example are known to it alone
                for name in base._members.keys() - names.keys():
                    if not base._members[name].__module__.startswith("laticauda"):
                        del base._members[name]
        return
    # Example 14 uses a distribution beside laticauda, which need not be installed for the tests.
    found = os.pathsep.join(
        [str(ROOT / "plugins/laticauda-gym/src"), *filter(None, [os.environ.get("PYTHONPATH")])]
    )
    environment = {
        **os.environ,
        "MPLBACKEND": "Agg",
        "PYTHONPATH": found,
        "PYTHONWARNINGS": "error",
    }
    done = subprocess.run(
        [sys.executable, example],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.stem)
def test_the_example_is_one_numbered_idea_on_one_page(example: Path):
    text = example.read_text(encoding="utf-8")
    assert example.stem[:2].isdigit()
    assert example.stem[2] == "_"
    assert text.startswith('"""')
    assert len(text.splitlines()) <= 110  # of 84 columns, which fit the gallery's boxes


def test_every_example_has_its_place_in_the_gallery():
    contents = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    assert not [
        example.name for example in EXAMPLES if f": gallery/{example.stem}.md\n" not in contents
    ]


def test_a_page_of_the_gallery_has_the_code_what_it_prints_and_the_picture_that_it_draws(
    tmp_path: Path,
):
    gallery = runpy.run_path(str(ROOT / "docs" / "make_gallery.py"))
    example = tmp_path / "01_one.py"
    example.write_text(EXAMPLE, encoding="utf-8")
    found = gallery["run"](example)
    assert found.printed == "2 m/s\n"
    assert [name for name, _ in found.pictures] == ["one.png"]
    page = gallery["page"](example, "01: One", found)
    assert page.startswith("# 01: One\n\nOne idea.\n\n![")
    assert "![One: the picture that the example draws](01_one-one.png)" in page
    assert "```python\nfrom pathlib" in page
    assert "```text\n2 m/s\n```" in page
    assert "python examples" not in page


EXAMPLE = '''"""One idea.

    python examples/01_one.py
"""

from pathlib import Path

Path("one.png").write_bytes(b"picture")
print(1 + 1, "m/s")
'''
