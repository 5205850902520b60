"""Claims about what the fin brings in speed, and what it costs in power."""

from collections.abc import Callable, Sequence
from statistics import median

from laticauda.paper.claims.claim import Finding, Statement, percent, share, spread, verdict
from laticauda.paper.efficiency import EfficiencyStudy
from laticauda.paper.measured import path_following_trials
from laticauda.paper.table1 import PRINTED_TO, FinGain, fin_gains, percent_change
from laticauda.robot import load_robot

PRINTED_GAIN = {"lateral_undulation": (47.03, 82.95), "eel_like": (33.64, 88.68)}
"""The gains in forward velocity that the paper's text states, smallest and largest [%]."""
NEARLY_DOUBLE = 90.0  # [%]
MORE_THAN = 88.0  # [%]
LITTLE_POWER = 10.0  # [%]
PRINTED_LENGTH = 30.0  # [%]


def _measured(gains: Sequence[FinGain]) -> list[float]:
    """The gains in velocity of Table 1, recomputed [%]."""
    return [gain.measured_velocity for gain in gains if gain.measured_velocity is not None]


def _simulated(gains: Sequence[FinGain], model: int = 0) -> list[float]:
    """The simulated gains at the rows with a measured one [%]."""
    return [gain.simulated_velocity[model] for gain in gains if gain.measured_velocity is not None]


def table2_changes() -> list[tuple[float, float]]:
    """Changes of velocity and power by the fin, case by case, recomputed from Table 2 [%]."""
    trials = path_following_trials()
    bare = {(trial.gait.kind, trial.case): trial for trial in trials if not trial.has_fin}
    pairs = [(bare[trial.gait.kind, trial.case], trial) for trial in trials if trial.has_fin]
    return [
        (
            percent_change(before.forward_velocity, after.forward_velocity),
            percent_change(before.mean_power, after.mean_power),
        )
        for before, after in pairs
    ]


def _gain(study: EfficiencyStudy, kind: str) -> Finding:
    gains = [gain for gain in fin_gains(study) if gain.with_fin.group.gait == kind]
    measured, first = _measured(gains), _simulated(gains)
    low, high = PRINTED_GAIN[kind]
    models = ", ".join(f"{name} {spread(_simulated(gains, i))}" for i, name in enumerate(study.models))
    text = (
        f"Recomputed from Table 1: {spread(measured, '+.2f')} over {len(measured)} settings. Simulated there, "
        f"{study.how['joints']} joints: {models}."
    )
    recomputed = abs(min(measured) - low) <= PRINTED_TO and abs(max(measured) - high) <= PRINTED_TO
    return text, verdict(recomputed, low <= min(first) and max(first) <= high)


def _nearly_double(study: EfficiencyStudy) -> Finding:
    gains = fin_gains(study)
    sources = {
        "Table 1": _measured(gains),
        "Table 2": [velocity for velocity, _ in table2_changes()],
        f"simulated at the settings of Table 1, {study.how['joints']} joints, {study.models[0]}": _simulated(gains),
    }
    text = "; ".join(
        f"{name}: {spread(values)}, median {percent(median(values))}, "
        f"{share([value >= NEARLY_DOUBLE for value in values])} reach {percent(NEARLY_DOUBLE)}"
        for name, values in sources.items()
    )
    return f"{text}.", verdict(*(median(values) >= NEARLY_DOUBLE for values in sources.values()))


def _more_than_88(study: EfficiencyStudy) -> Finding:
    gains = [gain for gain in fin_gains(study) if gain.measured_velocity is not None]
    table1, table2 = _measured(gains), [velocity for velocity, _ in table2_changes()]
    above = [value > MORE_THAN for value in [*table1, *table2]]
    rows = ", ".join(
        f"{gain.with_fin.group.name}, case {gain.with_fin.index + 1}, {percent(value, '+.2f')}"
        for gain, value in zip(gains, table1, strict=True)
        if value > MORE_THAN
    )
    simulated = [value > MORE_THAN for value in _simulated(gains)]
    text = (
        f"Above 88 %: Table 1, {share(above[: len(table1)])} ({rows or 'none'}); Table 2, "
        f"{share(above[len(table1) :])} ({spread(table2)}); simulated at the settings of Table 1, "
        f"{study.how['joints']} joints, {study.models[0]}: {share(simulated)}."
    )
    return text, verdict(any(above), all(above))


def _power_falls(study: EfficiencyStudy) -> Finding:
    gains = fin_gains(study)
    measured = [gain.measured_power for gain in gains if gain.measured_power is not None]
    simulated = _simulated_power(gains)
    fell = [value < 0.0 for value in measured]
    text = (
        f"Electrical power, recomputed from Table 1: it falls in {share(fell)} ({spread(measured, '+.1f')}); of "
        f"{len(gains)} settings, {len(gains) - len(measured)} lack a measurement. Simulated mechanical power, "
        f"{study.how['joints']} joints, {study.models[0]}: {spread(simulated)}."
    )
    return text, verdict(_most(fell), _most([value < 0.0 for value in simulated]))


def _little_power(study: EfficiencyStudy) -> Finding:
    table1 = [gain.measured_power for gain in fin_gains(study) if gain.measured_power is not None]
    table2 = [power for _, power in table2_changes()]
    text = (
        f"Electrical power: Table 1 {spread(table1, '+.1f')}; Table 2 {spread(table2, '+.1f')}. So the two tables of "
        "the paper do not agree with each other."
    )
    return text, verdict(max(table1) <= LITTLE_POWER, max(table2) <= LITTLE_POWER)


def _energy_per_meter(study: EfficiencyStudy) -> Finding:
    gains = fin_gains(study)
    table1 = [
        _per(gain.measured_power, gain.measured_velocity)
        for gain in gains
        if gain.measured_power is not None and gain.measured_velocity is not None
    ]
    table2 = [_per(power, velocity) for velocity, power in table2_changes()]
    velocities = [gain.simulated_velocity[0] for gain in gains]
    simulated = [_per(power, velocity) for power, velocity in zip(_simulated_power(gains), velocities, strict=True)]
    sources = {
        "Table 1": table1,
        "Table 2": table2,
        f"simulated (mechanical), {study.how['joints']} joints, {study.models[0]}": simulated,
    }
    text = "; ".join(
        f"{name}: {spread(values)}, less in {share([value < 0.0 for value in values])}"
        for name, values in sources.items()
    )
    parts = [_most([value < 0.0 for value in values]) for values in sources.values()]
    return f"Energy per meter with the fin: {text}.", verdict(*parts)


def _simulated_power(gains: Sequence[FinGain]) -> list[float]:
    """Simulated changes of the mechanical power, first model [%]."""
    return [percent_change(gain.without.mechanical_power[0], gain.with_fin.mechanical_power[0]) for gain in gains]


def _per(power: float, velocity: float) -> float:
    """Change of energy per meter from those of power and velocity [%]."""
    return 100.0 * ((100.0 + power) / (100.0 + velocity) - 1.0)


def _most(values: Sequence[bool]) -> bool:
    return 2 * sum(values) > len(values)


def _length() -> Finding:
    robot, modules = load_robot("mamba-fin"), load_robot("mamba-modules-fin")
    assert robot.caudal_fin is not None
    fin, link = robot.caudal_fin.length, robot.modules[0].length
    added, of_modules, of_printed = (100.0 * fin / length for length in (robot.length, modules.length, 20 * link))
    text = (
        f"{fin:g} m on {robot.length:g} m ({robot.n_links} links of {link:g} m): {percent(added)}; on "
        f"{modules.n_links} modules of {modules.modules[0].length:g} m: {percent(of_modules)}; on the 20 links of "
        f"{link:g} m of section 2 it would be {percent(of_printed)}."
    )
    return text, verdict(abs(added - PRINTED_LENGTH) <= 2.0)


def _for(kind: str) -> Callable[[EfficiencyStudy], Finding]:
    return lambda study: _gain(study, kind)


STATEMENTS = (
    Statement(
        key="fin-speed-lateral",
        where="4.5, Table 1",
        paper="At the same setting, the fin makes lateral undulation 47.03 to 82.95 % faster.",
        rule="The table's own speeds give this range; the simulated gains lie within it.",
        needs=("efficiency",),
        judge=_for("lateral_undulation"),
    ),
    Statement(
        key="fin-speed-eel",
        where="4.5, Table 1",
        paper="At the same setting, the fin makes eel-like motion 33.64 to 88.68 % faster.",
        rule="The table's own speeds give this range; the simulated gains lie within it.",
        needs=("efficiency",),
        judge=_for("eel_like"),
    ),
    Statement(
        key="fin-nearly-double",
        where="Abstract, 1, 4.5, 4.6",
        paper="The fin nearly doubles the forward velocity: almost +100 %.",
        rule="The median gain is +90 % or more in Table 1; in Table 2; in the simulation.",
        needs=("efficiency",),
        judge=_nearly_double,
    ),
    Statement(
        key="fin-more-than-88",
        where="5",
        paper="The fin raises the forward velocity by more than 88 %.",
        rule="Some settings of Tables 1 and 2 exceed 88 %; all of them do.",
        needs=("efficiency",),
        judge=_more_than_88,
    ),
    Statement(
        key="fin-power-falls",
        where="4.5, Table 1",
        paper="In most cases the fin even lowers the power.",
        rule="It falls at more than half of the settings as measured; as simulated.",
        needs=("efficiency",),
        judge=_power_falls,
    ),
    Statement(
        key="fin-little-power",
        where="5",
        paper="The fin costs little more power, or even saves some.",
        rule="No increase above 10 % in Table 1; in Table 2.",
        needs=("efficiency",),
        judge=_little_power,
    ),
    Statement(
        key="fin-efficiency",
        where="4.5",
        paper="A passive fin makes locomotion more efficient.",
        rule="Energy per meter falls at more than half of the settings of Table 1; of Table 2; in the simulation.",
        needs=("efficiency",),
        judge=_energy_per_meter,
    ),
    Statement(
        key="fin-length",
        where="4.5",
        paper="The fin makes the robot 30 % longer.",
        rule="Within 2 points for the robot of the published simulations.",
        judge=_length,
    ),
)
