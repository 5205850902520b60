"""The studies that the tests of the paper share, cut down to seconds, and trials made by formula."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from cli.conftest import folder, run
from trial.conftest import make_trial

from laticauda.paper import (
    EfficiencyStudy,
    PathFollowingStudy,
    efficiency_settings,
    path_following_settings,
    run_efficiency,
    run_path_following,
)

__all__ = ["folder", "make_trial", "run"]


@pytest.fixture(scope="session")
def study() -> EfficiencyStudy:
    """The whole Table 1, and sweeps in coarse steps that still meet the ends of their ranges."""
    settings = efficiency_settings()
    coarse = tuple(replace(sweep, step=5 * sweep.step) for sweep in settings.sweeps)
    return run_efficiency(replace(settings, sweeps=coarse))


@pytest.fixture(scope="session")
def following() -> PathFollowingStudy:
    """All 12 trials of Table 2 for 18 s, which takes some of them to the path, with prescribed joints only."""
    settings = replace(path_following_settings(), duration=18.0, joint_laws=("prescribed",))
    return run_path_following(settings)


@pytest.fixture
def short_reproduction(monkeypatch: pytest.MonkeyPatch) -> None:
    """`laticauda reproduce` in seconds: studies cut down or left out, no figures, no workers."""
    from laticauda.paper.report import experiments, reproduce

    whole_plan = experiments.paper_experiments

    def small(parameters: Any = None) -> experiments.Experiments:
        whole = whole_plan(parameters)
        sweeps = tuple(replace(sweep, step=10 * sweep.step) for sweep in whole.efficiency.sweeps)
        following = replace(whole.path_following, duration=16.0, joint_laws=("prescribed",), offset_bandwidths=(10.0,))
        return replace(whole, efficiency=replace(whole.efficiency, sweeps=sweeps), path_following=following)

    monkeypatch.setattr("os.cpu_count", lambda: 1)
    monkeypatch.setattr(experiments, "paper_experiments", small)
    runs = {name: run for name, run in reproduce.RUNS.items() if name not in ("stability", "beyond")}
    chapters = {
        name: (title, _without_figures(chapter))
        for name, (title, chapter) in reproduce.CHAPTERS.items()
        if name in runs
    }
    monkeypatch.setattr(reproduce, "RUNS", runs)
    monkeypatch.setattr(reproduce, "CHAPTERS", chapters)


def _without_figures(chapter: Callable[..., Any]) -> Callable[..., Any]:
    def bare(*args: Any, **kwargs: Any) -> Any:
        return replace(chapter(*args, **kwargs), n_figures=0, figures=lambda: iter(()))

    return bare
