"""A run of the program in this process."""

import shlex
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

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


@pytest.fixture
def short_reproduction(monkeypatch: pytest.MonkeyPatch) -> None:
    """`laticauda reproduce` in seconds: studies cut down or left out, no figures, no workers."""
    from laticauda import reports

    whole_plan = reports.paper_experiments

    def small(parameters: Any = None) -> reports.Experiments:
        whole = whole_plan(parameters)
        sweeps = tuple(replace(sweep, step=10 * sweep.step) for sweep in whole.efficiency.sweeps)
        following = replace(whole.path_following, duration=16.0, joint_laws=("prescribed",), offset_bandwidths=(10.0,))
        return replace(whole, efficiency=replace(whole.efficiency, sweeps=sweeps), path_following=following)

    module = sys.modules[reports.reproduce.__module__]
    monkeypatch.setattr("os.cpu_count", lambda: 1)
    monkeypatch.setattr(reports, "paper_experiments", small)
    runs = {name: run for name, run in module.RUNS.items() if name not in ("stability", "beyond")}
    chapters = {name: _without_figures(chapter) for name, chapter in module.CHAPTERS.items() if name in runs}
    monkeypatch.setattr(module, "RUNS", runs)
    monkeypatch.setattr(module, "CHAPTERS", chapters)


def _without_figures(chapter: Callable[..., Any]) -> Callable[..., Any]:
    def bare(*args: Any, **kwargs: Any) -> Any:
        return replace(chapter(*args, **kwargs), n_figures=0, figures=lambda: iter(()))

    return bare
