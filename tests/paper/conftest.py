"""The studies that the tests of the paper share, cut down to seconds, and trials made by formula."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from cli.conftest import folder, run
from synthetic_trials import make_trial

from laticauda.paper import (
    EfficiencyStudy,
    PathFollowingStudy,
    load_efficiency_settings,
    load_path_following_settings,
    run_efficiency,
    run_path_following,
)

__all__ = ["folder", "make_trial", "run"]


@pytest.fixture(scope="session")
def study() -> EfficiencyStudy:
    """The whole Table 1, and sweeps in coarse steps that still meet the ends of their ranges."""
    settings = load_efficiency_settings()
    coarse = tuple(replace(sweep, step=5 * sweep.step) for sweep in settings.sweeps)
    return run_efficiency(replace(settings, sweeps=coarse, models=settings.models[:2]))


@pytest.fixture(scope="session")
def following() -> PathFollowingStudy:
    """All 12 trials of Table 2 for 18 s, which takes some of them to the path, with prescribed joints only."""
    return run_path_following(
        replace(load_path_following_settings(), duration=18.0, joint_laws=("prescribed",), own=())
    )


@pytest.fixture(scope="session")
def beside() -> tuple[EfficiencyStudy, PathFollowingStudy]:
    """The paper's coefficients with one of our own models beside them: Table 1, and six trials of Table 2 for 16 s."""
    settings, following = load_efficiency_settings(), load_path_following_settings()
    sweeps = tuple(replace(sweep, step=20 * sweep.step) for sweep in settings.sweeps)
    settings = replace(settings, sweeps=sweeps, models=settings.models[::2])
    short = replace(following, duration=16.0, joint_laws=("prescribed",), offset_bandwidths=(10.0,))
    short = replace(short, groups=following.groups[:2], own=following.own[:1])
    return run_efficiency(settings), run_path_following(short)


@pytest.fixture
def short_reproduction(monkeypatch: pytest.MonkeyPatch) -> None:
    """`laticauda reproduce` in seconds: studies cut down, no figures, no workers."""
    from laticauda.paper.report import reproduce

    whole_plan = reproduce.plan_experiments

    def small(parameters: Any = None) -> reproduce.Experiments:
        whole = whole_plan(parameters)
        sweeps = tuple(replace(sweep, step=10 * sweep.step) for sweep in whole.efficiency.sweeps)
        following = replace(
            whole.path_following,
            duration=16.0,
            joint_laws=("prescribed",),
            offset_bandwidths=(10.0,),
        )
        following = replace(following, own=following.own[:1])
        models = tuple(one for one in whole.efficiency.models if one.name != "mamba-textbook")
        efficiency = replace(whole.efficiency, sweeps=sweeps, models=models)
        return replace(whole, efficiency=efficiency, path_following=following)

    monkeypatch.setattr("os.cpu_count", lambda: 1)
    monkeypatch.setattr(reproduce, "plan_experiments", small)
    chapters = {
        name: chapter._replace(build=_without_figures(chapter.build))
        for name, chapter in reproduce.CHAPTERS.items()
    }
    monkeypatch.setattr(reproduce, "CHAPTERS", chapters)


def _without_figures(chapter: Callable[..., Any]) -> Callable[..., Any]:
    def bare(*args: Any, **kwargs: Any) -> Any:
        return replace(chapter(*args, **kwargs), n_figures=0, figures=lambda: iter(()))

    return bare
