"""A run of the program in this process."""

import shlex
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

from laticauda.cli import main


class Done(NamedTuple):
    status: int
    out: str
    err: str


Run = Callable[[str], Done]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def run(folder: Path, capsys: pytest.CaptureFixture[str]) -> Iterator[Run]:
    """Run a command line, written as in a shell, in an empty folder."""

    def run(line: str) -> Done:
        capsys.readouterr()
        status = main(shlex.split(line))
        return Done(status, *capsys.readouterr())

    yield run
