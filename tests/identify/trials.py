"""Simulated measurements that the tests of identification share."""

from dataclasses import replace

import numpy as np

import laticauda as lc
from laticauda.identify import Measurement

ROBOT = lc.load_robot("mamba")
FINNED = lc.load_robot("mamba-fin")
WATER = lc.load_water("paper-lateral")
FRICTION = "water.tangential_friction"
DRAG = "water.normal_drag"
MASS = "water.added_mass"


def within(measurement, **changes):
    """A measurement in another scenario."""
    return replace(measurement, scenario=replace(measurement.scenario, **changes))


def gaits(n, seed=1):
    rng = np.random.default_rng(seed)
    ranges = {"amplitude": (0.3, 0.7), "frequency": (1.2, 2.6), "phase_shift": (0.4, 1.0)}
    return [
        lc.lateral_undulation(**{name: rng.uniform(*ends) for name, ends in ranges.items()})
        for _ in range(n)
    ]


def speeds(
    n=8,
    *,
    sigma=0.002,
    noise=0.0,
    seed=1,
    duration=8.0,
    figure="forward_velocity",
    joints="prescribed",
    **true,
):
    """Simulated figures in a water that is not the one that a fit begins with."""
    water = replace(WATER, **({"tangential_friction": 0.2} | true))
    asked = gaits(n, seed)
    found = getattr(lc.swim_many(ROBOT, asked, duration, environments=water, joints=joints), figure)
    found = found + noise * np.random.default_rng(seed).standard_normal(n)
    return [
        Measurement(
            name=f"trial {i}",
            scenario=lc.build_scenario(ROBOT, gait, duration, environment=WATER),
            figures={figure: (float(value), sigma)},
        )
        for i, (gait, value) in enumerate(zip(asked, found, strict=True))
    ]
