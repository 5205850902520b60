"""Runs of all kinds to draw."""

import math
from dataclasses import replace
from functools import cache

import laticauda as lc
from laticauda.scenarios import limit_case

WATER = lc.load_water("paper-lateral")


def lateral(offset_deg: float = 0.0, frequency_deg_s: float = 130.0) -> lc.Gait:
    return lc.Gait(
        amplitude=math.radians(30),
        frequency=math.radians(frequency_deg_s),
        phase_shift=math.radians(40),
        offset=math.radians(offset_deg),
    )


def eel_like() -> lc.Gait:
    return lc.eel_like(
        amplitude=math.radians(50), frequency=math.radians(110), phase_shift=math.radians(40)
    )


def failed_at_once() -> lc.Trial:
    """A run that no robot can do."""
    with limit_case():
        return lc.swim(lc.load_robot("mamba"), lateral(frequency_deg_s=1e9), 3.0)


RUNS = {
    "lateral": lambda: lc.swim(lc.load_robot("mamba"), lateral()),
    "eel": lambda: lc.swim(lc.load_robot("mamba"), eel_like()),
    "fin": lambda: lc.swim(lc.load_robot("mamba-fin"), lateral()),
    "eel with fin": lambda: lc.swim(lc.load_robot("mamba-modules-fin"), eel_like()),
    "curve": lambda: lc.swim(lc.load_robot("mamba"), lateral(10.0)),
    "circle": lambda: lc.swim(lc.load_robot("mamba"), lateral(3.0), 120.0),
    "short": lambda: lc.swim(lc.load_robot("mamba"), lateral(), 5.0),
    "ground": lambda: lc.swim(
        lc.load_robot("mamba"), lateral(), environment=lc.load_ground("viscous")
    ),
    "current": lambda: lc.swim(
        lc.load_robot("mamba"), lateral(), environment=replace(WATER, current=(-0.05, 0.1))
    ),
    "north": lambda: lc.swim(lc.load_robot("mamba"), lateral(), start=lc.Start(heading=1.6)),
    "servo": lambda: lc.swim(lc.load_robot("mamba"), lateral(), joints="servo"),
    "two links": lambda: lc.swim(lc.load_robot("chain", n_links=2), lateral()),
    "one link": lambda: lc.swim(lc.load_robot("chain", n_links=1), lateral()),
    "tiny": lambda: lc.swim(lc.load_robot("mamba"), lateral(), 0.01),
    "still": lambda: lc.swim(lc.load_robot("mamba"), lateral(frequency_deg_s=0.0), 3.0),
    "failed": lambda: lc.swim(
        lc.load_robot("mamba"), lateral(frequency_deg_s=700.0), dt=0.5, sample_interval=0.5
    ),
    "failed at once": failed_at_once,
}


@cache
def run(name: str) -> lc.Trial:
    return RUNS[name]()
