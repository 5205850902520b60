"""The examples run, are short, and are shown in the docs."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.stem)
def test_the_example_runs(example: Path, tmp_path: Path):
    environment = {**os.environ, "MPLBACKEND": "Agg", "PYTHONWARNINGS": "error"}
    done = subprocess.run(
        [sys.executable, example], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.stem)
def test_the_example_is_one_numbered_idea_on_one_page(example: Path):
    text = example.read_text(encoding="utf-8")
    assert example.stem[:2].isdigit()
    assert example.stem[2] == "_"
    assert text.startswith('"""')
    assert len(text.splitlines()) <= 60


def test_every_example_is_shown_in_the_docs():
    page = (ROOT / "docs" / "examples.md").read_text(encoding="utf-8")
    assert not [example.name for example in EXAMPLES if f'--8<-- "examples/{example.name}"' not in page]
