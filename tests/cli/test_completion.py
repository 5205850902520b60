"""The shell function of docs/install.md, in a real bash."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "install.md"
ASK = 'COMP_WORDS=(laticauda "$@"); COMP_CWORD=$#; _laticauda; echo "${COMPREPLY[@]}"'


@pytest.mark.skipif(shutil.which("bash") is None, reason="no bash here")
@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        (["sw"], "swim sweep"),
        (["trial", ""], "show compare plot convert"),
        (["swim", "--amp"], "--amplitude-deg"),
        (["swim", "--model", "spatial", "--sce"], "--scene"),
        (["swim", "--robot", ""], ""),  # a value: bash offers file names
    ],
)
def test_tab_offers_what_the_program_has(typed: list[str], offered: str, tmp_path: Path):
    (function,) = re.findall(
        r"```bash\n(_laticauda\(\).*?)```", PAGE.read_text(encoding="utf-8"), re.S
    )
    program = tmp_path / "laticauda"
    start = "import sys; from laticauda.cli import main; sys.exit(main())"
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -c "{start}" "$@"\n', encoding="utf-8")
    program.chmod(0o755)
    words = ["bash", "--norc", "-c", f"{function}\n{ASK}", "bash", *typed]
    path = {**os.environ, "PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}", "COLUMNS": "80"}
    answer = subprocess.run(words, env=path, capture_output=True, text=True, check=True)
    assert answer.stdout.split() == offered.split(), answer.stderr
