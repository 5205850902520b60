"""Claims about how well the simulated speeds agree with the measured ones."""

from collections.abc import Callable

import numpy as np

from laticauda.paper.claims.claim import Finding, Statement, spread, verdict
from laticauda.paper.efficiency import EfficiencyStudy
from laticauda.paper.scores import scores
from laticauda.paper.table1 import percent_change

PAPERS = ("analytical-set", "vortex-set")
"""The paper's coefficients for its analytical model, and for its Vortex model."""
GOOD = 10.0  # mean absolute error that counts as good agreement [%]


def _errors(study: EfficiencyStudy, group: str, model: int = 0) -> list[float]:
    """Errors of the simulated forward velocity over the measured rows of a group of Table 1 [%]."""
    return [
        percent_change(case.measured_velocity, case.forward_velocity[model])
        for case in study.measured
        if case.group.name == group and case.measured_velocity is not None
    ]


def _mean(errors: list[float]) -> float:
    """Mean absolute error [%]."""
    return float(np.mean(np.abs(errors)))


def _agreement_in(*groups: str) -> Callable[[EfficiencyStudy], Finding]:
    return lambda study: _agreement(study, *groups)


def _agreement(study: EfficiencyStudy, *groups: str) -> Finding:
    errors = {group: _errors(study, group) for group in groups}
    text = "; ".join(
        f"{group}: mean absolute error {_mean(found):.1f} % over {len(found)} measured rows ({spread(found)})"
        for group, found in errors.items()
    )
    parts = [part for found in errors.values() for part in (_mean(found) <= GOOD, max(map(abs, found)) <= GOOD)]
    return f"{_how(study)}, {text}.", verdict(*parts)


def _how(study: EfficiencyStudy) -> str:
    return f"Simulated, {study.how['joints']} joints, {study.models[0]}"


def _vortex_is_closer(study: EfficiencyStudy) -> Finding:
    if not set(PAPERS) <= set(study.models):
        return "Not run: both of the paper's sets of coefficients.", "not tested here"
    groups = [group.name for group in study.settings.groups if group.has_fin]
    places = [study.models.index(name) for name in PAPERS]
    errors = [[_mean(_errors(study, group, place)) for place in places] for group in groups]
    words = [f"{group}: {one:.1f} % and {other:.1f} %" for group, (one, other) in zip(groups, errors, strict=True)]
    text = (
        f"Mean absolute error of {' and '.join(PAPERS)}, {study.how['joints']} joints: {'; '.join(words)}. Both are "
        f"the {study.how['model']} model here: only the coefficients differ."
    )
    return text, verdict(*(other < one for one, other in errors))


def _poorer_with_fin(study: EfficiencyStudy) -> Finding:
    pairs: list[tuple[float, float]] = []
    words: list[str] = []
    for gait in dict.fromkeys(group.gait for group in study.settings.groups):
        bare, fin = (
            next(group.name for group in study.settings.groups if (group.gait, group.has_fin) == (gait, has_fin))
            for has_fin in (False, True)
        )
        pairs.append((_mean(_errors(study, bare)), _mean(_errors(study, fin))))
        words.append(f"{bare} {pairs[-1][0]:.1f} %, with it {pairs[-1][1]:.1f} %")
    text = f"{_how(study)}, mean absolute error: {'; '.join(words)}."
    return text, verdict(*(fin > bare for bare, fin in pairs))


def _accurate(study: EfficiencyStudy) -> Finding:
    found = scores(study)
    own = found[0]
    null = [(score.leave_one_out, score.name) for score in found if score.leave_one_out is not None]
    error, name = min(null)
    text = (
        f"{_how(study)}: mean absolute error {own.overall:.1f} % over {len(study.measured)} measured rows; the best "
        f"model without physics ({name}) misses rows that it was not fitted to by {error:.1f} %."
    )
    return text, verdict(own.overall <= GOOD, own.overall < error)


def _repeatable() -> Finding:
    return (
        "The single trials are in the paper's figures only; its tables have one speed per setting.",
        "not tested here",
    )


STATEMENTS = (
    Statement(
        key="agreement-lateral",
        where="4.5, Fig. 4",
        paper="Without fin, simulation and robot agree very well in lateral undulation, over amplitude, frequency and "
        "phase shifts of 35 to 50 deg.",
        rule="The mean absolute error is 10 % or less; that of every measured row is.",
        needs=("efficiency",),
        judge=_agreement_in("lateral undulation, without fin"),
    ),
    Statement(
        key="agreement-lateral-fin",
        where="4.5, Fig. 5 (printed: 4)",
        paper="With the fin, the agreement in lateral undulation is good, too.",
        rule="The mean absolute error is 10 % or less; that of every measured row is.",
        needs=("efficiency",),
        judge=_agreement_in("lateral undulation, with fin"),
    ),
    Statement(
        key="agreement-eel",
        where="4.5, Figs. 6, 7",
        paper="In eel-like motion the agreement is good, without and with the fin.",
        rule="In each of both groups the mean absolute error is 10 % or less; that of every measured row is.",
        needs=("efficiency",),
        judge=_agreement_in("eel-like motion, without fin", "eel-like motion, with fin"),
    ),
    Statement(
        key="vortex-closer",
        where="4.5",
        paper="With the fin, the Vortex model comes closer to the robot than the analytical one.",
        rule="The Vortex coefficients have the smaller mean error in lateral undulation; in eel-like motion.",
        needs=("efficiency",),
        judge=_vortex_is_closer,
    ),
    Statement(
        key="poorer-with-fin",
        where="Remark 3",
        paper="The simulations are less accurate with the fin, because they were tuned without it.",
        rule="The mean error is larger with the fin in lateral undulation; in eel-like motion.",
        needs=("efficiency",),
        judge=_poorer_with_fin,
    ),
    Statement(
        key="accurate",
        where="4.4, Remark 2",
        paper="With the chosen coefficients, the simulation represents the robot accurately over wide ranges.",
        rule="The mean absolute error over Table 1 is 10 % or less; it is less than that of models without physics.",
        needs=("efficiency",),
        judge=_accurate,
    ),
    Statement(
        key="repeatable",
        where="4.5, Figs. 4 to 7",
        paper="Three sets of trials show that the measurements repeat.",
        rule="The trials of a setting scatter less than the settings differ.",
        judge=_repeatable,
    ),
)
