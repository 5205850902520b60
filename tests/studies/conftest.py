from dataclasses import replace

import pytest

from laticauda.studies import (
    EfficiencyStudy,
    PathFollowingStudy,
    efficiency_settings,
    path_following_settings,
    run_efficiency,
    run_path_following,
)


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
