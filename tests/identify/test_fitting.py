from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.identify import Measurement, fit

ROBOT = lc.load_robot("mamba")
WATER = lc.load_water("paper-lateral")
TRUTH = {"water.tangential_friction": 0.2, "water.normal_drag": 1.4}
RATIO = "water.tangential_friction"
SIGMA = 0.002


def gaits(n, seed=1):
    rng = np.random.default_rng(seed)
    ranges = {"amplitude": (0.3, 0.7), "frequency": (1.2, 2.6), "phase_shift": (0.4, 1.0)}
    return [lc.lateral_undulation(**{name: rng.uniform(*ends) for name, ends in ranges.items()}) for _ in range(n)]


def speeds(n=8, sigma=SIGMA, noise=0.0, seed=1, duration=10.0, **true):
    """Simulated speeds of a water that is not the one that the fit begins with."""
    water = replace(WATER, **{name: value for name, value in ({"tangential_friction": 0.2} | true).items()})
    asked = gaits(n, seed)
    found = lc.swim_many(ROBOT, asked, duration, environments=water).forward_velocity
    found = found + noise * np.random.default_rng(seed).standard_normal(n)
    return [
        Measurement(
            name=f"trial {i}",
            gait=gait,
            robot=ROBOT,
            environment=WATER,
            duration=duration,
            figures={"forward_velocity": (float(speed), sigma)},
        )
        for i, (gait, speed) in enumerate(zip(asked, found, strict=True))
    ]


def test_without_noise_the_truth_comes_back_exactly():
    found = fit(speeds(normal_drag=1.4), parameters=list(TRUTH), n_starts=2)
    for name, value in TRUTH.items():
        assert found[name].value == pytest.approx(value, rel=1e-6)
    assert found.chi2 < 1e-9
    assert found.n_agreeing == 2
    assert "2 of 2 starts agree" in found.status
