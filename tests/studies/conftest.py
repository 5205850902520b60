from dataclasses import replace

import pytest

from laticauda.studies import EfficiencyStudy, efficiency_settings, run_efficiency


@pytest.fixture(scope="session")
def study() -> EfficiencyStudy:
    """The whole Table 1, and sweeps in coarse steps that still meet the ends of their ranges."""
    settings = efficiency_settings()
    coarse = tuple(replace(sweep, step=5 * sweep.step) for sweep in settings.sweeps)
    return run_efficiency(replace(settings, sweeps=coarse))
