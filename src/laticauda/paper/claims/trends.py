"""Claims about trends over the gait's parameters, and about what the models leave out."""

import math
from itertools import combinations

import numpy as np
from jaxtyping import Float

from laticauda.gaits import GAIT_WORDS
from laticauda.paper.claims.claim import Finding, Statement, percent, share, verdict
from laticauda.paper.efficiency import EfficiencyStudy
from laticauda.paper.parity import ParityStudy
from laticauda.paper.side_trials import SHALLOW, SideTrials
from laticauda.paper.table1 import maxima, percent_change
from laticauda.robot import load_water

PRINTED_OPTIMUM, NEAR = 25.0, 2.5  # of the phase shift in the paper's simulation, and what still counts as it [deg]
CLOSE = 5.0  # to a marked setting [deg, deg/s]
PROPORTIONAL = 0.99  # coefficient of determination of a line through the origin [-]
NEGLIGIBLE = 1.0  # [%]
SAME_TREND = 2.0 / 3.0  # share of pairs of settings that are ordered alike [-]

Values = Float[np.ndarray, " n_values"]


def _phase_optimum(study: EfficiencyStudy, side: SideTrials) -> Finding:
    entry = next(
        one for one in maxima(study) if one.parameter == "phase_shift" and one.group == study.settings.groups[0]
    )
    chosen, pd = math.degrees(entry.simulated_at[0]), math.degrees(side.pd_optimum)
    text = (
        f"Fastest at {chosen:.0f} deg with {study.how['joints']} joints and at {pd:.0f} deg with pd joints, the law of "
        f"the published simulations ({study.models[0]}); measured {math.degrees(entry.measured_at):.0f} deg."
    )
    return text, verdict(*(abs(found - PRINTED_OPTIMUM) <= NEAR for found in (chosen, pd)))


def _speed_law(study: EfficiencyStudy) -> Finding:
    sweep = next(sweep for sweep in study.sweeps if sweep.settings.parameter == "frequency")
    simulated = [_through_origin(sweep.values, curve) for curve in sweep.forward_velocity[0]]
    measured: dict[str, tuple[float, float]] = {}
    for group in study.settings.groups:
        rows = [case for case in study.measured if case.group == group and sweep.settings.contains(case.gait)]
        slow, fast = (pick(rows, key=lambda case: case.gait.frequency) for pick in (min, max))
        assert slow.measured_velocity is not None and fast.measured_velocity is not None
        change = percent_change(slow.measured_velocity, fast.measured_velocity)
        measured[group.name] = change, percent_change(slow.gait.frequency, fast.gait.frequency)
    words = "; ".join(f"{name} {percent(change)}" for name, (change, _) in measured.items())
    frequency = max(wanted for _, wanted in measured.values())
    text = (
        f"Simulated, {study.how['joints']} joints, {study.models[0]}, lines through the origin explain "
        f"{100 * min(simulated):.1f} % or more of the velocity over the frequency. Measured, {percent(frequency)} in "
        f"frequency changes it by: {words}."
    )
    return text, verdict(min(simulated) >= PROPORTIONAL, all(change > 0.0 for change, _ in measured.values()))


def _maxima(study: EfficiencyStudy) -> Finding:
    found = maxima(study)
    near = [abs(one.simulated_at[0] - one.measured_at) <= math.radians(CLOSE) + 1e-9 for one in found]
    ends = [one.at_the_end[0] for one in found]
    text = (
        f"{share(near)} simulated maxima ({study.how['joints']} joints, {study.models[0]}) lie within {CLOSE:g} deg or "
        f"deg/s of the marked settings; {share(ends)} lie at the end of the range that was simulated."
    )
    return text, verdict(*near)


def _through_origin(x: Values, y: Values) -> float:
    """Coefficient of determination of the best line y = k x [-]."""
    residual = y - x * float(x @ y) / float(x @ x)
    return 1.0 - float(residual @ residual) / float(np.sum((y - np.mean(y)) ** 2))


def _power_trend(study: EfficiencyStudy) -> Finding:
    words: list[str] = []
    parts: list[bool] = []
    for group in study.settings.groups:
        rows = [
            (case.measured_power, case.mechanical_power[0])
            for case in study.cases
            if case.group == group and case.measured_power is not None
        ]
        alike = [(one[0] - other[0]) * (one[1] - other[1]) > 0.0 for one, other in combinations(rows, 2)]
        words.append(f"{group.name} {share(alike)}")
        parts.append(sum(alike) >= SAME_TREND * len(alike))
    text = (
        f"Pairs of settings whose measured electrical and simulated mechanical power ({study.how['joints']} joints, "
        f"{study.models[0]}) are ordered alike: {'; '.join(words)}."
    )
    return text, verdict(*parts)


def _surface_and_tether(study: EfficiencyStudy, side: SideTrials) -> Finding:
    rows = {(case.group.name, round(math.degrees(case.gait.frequency))): case.measured_velocity for case in study.cases}
    changes = {
        group: percent_change(slow, fast)
        for group in (group.name for group in study.settings.groups)
        for slow, fast in [(rows[group, 130], rows[group, 150])]
        if slow is not None and fast is not None
    }
    words = "; ".join(f"{group} {percent(value)}" for group, value in changes.items())
    depth = ", ".join(f"{GAIT_WORDS[kind]} {percent(value, '+.1f')}" for kind, value in side.by_depth.items())
    text = (
        f"Measured from 130 to 150 deg/s (Table 1): {words}; so with the fin, where the robot is the faster, its speed "
        f"does not fall. In the model the surface acts on the added mass alone ({side.joints} joints): {depth} with "
        f"the axis at {SHALLOW:g} m instead of deep. The drag of the tether is not known."
    )
    return text, "not tested here"


def _added_inertia(side: SideTrials) -> Finding:
    changes = side.by_added_inertia
    words = ", ".join(f"{GAIT_WORDS[kind]} {percent(change, '+.1e')}" for kind, change in changes.items())
    how = f"{side.joints} joints, {side.settings.coefficients.name}"
    text = f"Without it the forward velocity, simulated ({how}), changes by: {words}."
    return text, verdict(*(abs(change) <= NEGLIGIBLE for change in changes.values()))


def _eel_drag() -> Finding:
    lateral, eel = (load_water(name).tangential_friction for name in ("paper-lateral", "paper-eel"))
    text = (
        f"The coefficients that the paper identified say so: C_f {eel:g} for eel-like motion against {lateral:g}. But "
        "they were fitted to these speeds and prove nothing."
    )
    return text, "not tested here"


def _same_as_vortex(study: ParityStudy) -> Finding:
    dt, path = min(study.worst("path").items())
    text = (
        "The same robot, coefficients and gaits in a 3D engine (MuJoCo with added mass, no gravity, planar root), "
        f"{study.joints} joints: paths over 30 s differ by {100.0 * path:.1g} % of the distance or less at a "
        f"step of {1000.0 * dt:g} ms. Vortex itself could not be run here."
    )
    return text, verdict(path <= 0.003)


STATEMENTS = (
    Statement(
        key="phase-optimum",
        where="4.5, Fig. 4c",
        paper="Lateral undulation is fastest at a phase shift of 25 deg in simulation, and at 35 deg on the robot.",
        rule="The simulated optimum is within 2.5 deg of 25 deg with the joints used here; with pd joints.",
        needs=("efficiency", "side"),
        judge=_phase_optimum,
    ),
    Statement(
        key="maxima",
        where="4.5, Table 1",
        paper="Table 1 marks the setting at which each of 12 sweeps is fastest.",
        rule="Each of the simulated sweeps is fastest within 5 deg or deg/s of it.",
        needs=("efficiency",),
        judge=_maxima,
    ),
    Statement(
        key="speed-law",
        where="4.5, 4.6, after its [21]",
        paper="The speed follows the gait parameters as averaging theory says (it is in proportion to the frequency), "
        "with the fin too; so it can be set without feedback.",
        rule="The simulated velocity is in proportion to the frequency (99 % explained) in all groups; the measured "
        "one rises with it in all groups.",
        needs=("efficiency",),
        judge=_speed_law,
    ),
    Statement(
        key="power-trend",
        where="4.5, Figs. 8 to 11",
        paper="The measured power follows the trend of the theory.",
        rule="In each of the four groups, two thirds of the pairs of settings are ordered alike.",
        needs=("efficiency",),
        judge=_power_trend,
    ),
    Statement(
        key="surface-and-tether",
        where="Remark 1",
        paper="At high velocity, surface and tether may have slowed the robot down.",
        rule="It takes trials below the surface, or without a tether.",
        needs=("efficiency", "side"),
        judge=_surface_and_tether,
    ),
    Statement(
        key="added-inertia",
        where="4.4",
        paper="The added inertia C_M hardly matters and can be left at 1.",
        rule="The forward velocity changes by 1 % or less without it, in lateral undulation; in eel-like motion.",
        needs=("side",),
        judge=_added_inertia,
    ),
    Statement(
        key="eel-drag",
        where="4.5",
        paper="Eel-like motion has less drag along the body, because its front swings less; the models lack this.",
        rule="It takes coefficients that were not fitted to the same speeds.",
        judge=_eel_drag,
    ),
    Statement(
        key="same-as-vortex",
        where="Remark 2",
        paper="With the same coefficients, the analytical model gives the results of the Vortex model.",
        rule="Two models with the same coefficients give paths that differ by 0.3 % of the distance or less.",
        needs=("parity",),
        judge=_same_as_vortex,
    ),
)
