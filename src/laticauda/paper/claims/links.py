"""Claims about what more links bring in speed, and what they cost in power."""

import math
from collections.abc import Callable

from laticauda.gaits import GAIT_WORDS
from laticauda.paper.claims.claim import Finding, Statement, percent, verdict
from laticauda.paper.links import Doubling, LinksStudy

LINKS_SPEED = 20.0  # [%]
LINKS_POWER = (8.0, 12.0)  # "almost a factor of 10" [-]


def _links_speed(study: LinksStudy) -> Finding:
    text = _links_words(study, lambda one: percent(one.velocity_change))
    return text, verdict(*(one.velocity_change < LINKS_SPEED for one in _as_they_are(study)))


def _links_power(study: LinksStudy) -> Finding:
    text = _links_words(study, lambda one: f"{one.power_factor:.1f} times")
    low, high = LINKS_POWER
    return text, verdict(*(low <= one.power_factor <= high for one in _as_they_are(study)))


def _as_they_are(study: LinksStudy) -> list[Doubling]:
    """The doublings with the same gait parameters."""
    return [one for one in study.doublings if one.kept == "phase shift"]


def _links_words(study: LinksStudy, words: Callable[[Doubling], str]) -> str:
    """Both gaits, for what was kept, in words."""
    short, long = study.settings.n_links
    kinds = {
        "phase shift": f"with the same phase shift, so {long / short:g} times the waves on the body",
        "number of waves": "with the same number of waves",
    }
    found: list[str] = []
    for kept, meaning in kinds.items():
        values = [f"{GAIT_WORDS[one.shorter.gait.kind]} {words(one)}" for one in study.doublings if one.kept == kept]
        found.append(f"{meaning}: {', '.join(values)}")
    settings = study.settings
    alpha, omega, delta = (
        f"{math.degrees(value):g}" for value in (settings.amplitude, settings.frequency, settings.phase_shift)
    )
    return (
        f"From {short} to {long} links like those of {settings.robot}, simulated, {study.how['joints']} joints, "
        f"{settings.coefficients.name}, at {alpha} deg, {omega} deg/s, {delta} deg: {'; '.join(found)}."
    )


STATEMENTS = (
    Statement(
        key="links-speed",
        where="4.5, after its [41]",
        paper="20 links instead of 10 make the robot less than 20 % faster, with either gait.",
        rule="So it is at the same gait parameters for lateral undulation; for eel-like motion.",
        needs=("links",),
        judge=_links_speed,
    ),
    Statement(
        key="links-power",
        where="4.5, after its [41]",
        paper="20 links instead of 10 take almost 10 times the power.",
        rule="8 to 12 times the mechanical power at the same gait parameters for lateral undulation; for eel-like "
        "motion.",
        needs=("links",),
        judge=_links_power,
    ),
)
