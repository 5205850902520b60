"""What the path-following study found, in sentences that are made of its numbers."""

import math
from collections.abc import Iterator, Sequence

from laticauda.gaits import GAIT_WORDS
from laticauda.paper.following_run import FollowingRun
from laticauda.paper.path_following import FollowingCase, PathFollowingStudy
from laticauda.paper.report.efficiency import JOINTS, water_in_words
from laticauda.paper.table2 import fin_changes, following_scores, meter_costs, null_predictions
from laticauda.reports.tables import in_digits


def settings_in_words(study: PathFollowingStudy) -> Iterator[str]:
    """How everything was run.

    Args:
        study: What `run_path_following` returned.
    """
    settings, how = study.settings, study.how
    yield (
        f"Guidance: line of sight to the x axis with a look-ahead distance of {settings.look_ahead_distance:g} m; "
        f"heading gain {settings.gain:g}, offset within ±{math.degrees(settings.max_offset):g} deg, asked for every "
        f"{settings.control_interval:g} s. These are the paper's gains."
    )
    yield (
        f"A run ends after {settings.duration:g} s or {settings.distance:g} m of progress in x, whichever comes first, "
        "and its forward velocity (5) is taken over all of it, the way to the path included. The paper states neither "
        "duration nor window."
    )
    yield "Initial conditions as printed: straight, at rest, p_y positive, that is to the left of the path."
    yield (
        "The bandwidth is that of the filter through which the reference generator takes on an offset. It is no "
        "detail: with the raw heading the offset swings with the gait, and the filter decides how much of that arrives."
    )
    yield f"Model: {how['model']}."
    for runs in _by_law(study).values():
        yield _law(runs)
    yield "Robots: {}.".format(", ".join(dict.fromkeys(group.robot for group in settings.groups)))
    model = settings.coefficients
    waters = [f"{water_in_words(model.water(gait))} for {GAIT_WORDS[gait]}" for gait in model.waters]
    yield f"Coefficients: {'; '.join(waters)}."


def findings(study: PathFollowingStudy) -> Iterator[str]:
    """What came out.

    Args:
        study: What `run_path_following` returned.
    """
    yield _way_there(study)
    yield _kept(study, [case.run for case in study.cases])
    for i, run in enumerate(study.cases[0].band):
        if run.name != study.cases[0].run.name:
            yield _kept(study, [case.band[i] for case in study.cases])
    yield _kept(study, [case.cycle_mean for case in study.cases])
    yield from _errors(study)
    yield from _changed_by_the_loop(study)
    yield from _fin(study)
    yield from _costs(study)


def held_out_verdict(study: PathFollowingStudy) -> Iterator[str]:
    """Whether the trial of another publication comes out as published, and by how much not.

    Args:
        study: What `run_path_following` returned.
    """
    held, settings = study.held_out, study.held_out.settings
    gait = settings.gait
    amplitude, frequency, phase_shift, heading = (
        math.degrees(angle) for angle in (gait.amplitude, gait.frequency, gait.phase_shift, settings.initial_heading)
    )
    yield (
        f"{GAIT_WORDS[gait.kind].capitalize()} of {settings.robot}, {amplitude:g} deg, {frequency:g} deg/s, "
        f"{phase_shift:g} deg, from a heading of {in_digits(heading, '.1f')} deg and p_y = "
        f"{settings.initial_cross_track_error:g} m (published 2016), here with the gains above and {held.run.name}."
    )
    if held.run.converged:
        after, distance = held.run.figures["convergence_time"], held.run.figures["convergence_distance"]
        yield (
            f"It converges, after {after:.1f} s and {distance:.2f} m; in the last third its cycle-mean error is at "
            f"most {_cm(held.run.last_third_largest)}."
        )
    else:
        yield "It does not converge."
    low, high = settings.velocity
    yield (
        f"Published forward velocity: {low:g} to {high:g} m/s. Here, from the second gait cycle on, the velocity along "
        f"the heading is {_range(held.velocity, '.3f')} m/s, {_beyond(held.velocity, (low, high), 'm/s')}; its mean "
        f"over the gait cycle is {_range(held.mean_velocity, '.4f')} m/s, "
        f"{_beyond(held.mean_velocity, (low, high), 'm/s')}."
    )
    found = (math.degrees(held.offset[0]), math.degrees(held.offset[1]))
    known = (math.degrees(settings.offset[0]), math.degrees(settings.offset[1]))
    yield (
        f"Published offset: {in_digits(known[0], '.0f')} to {known[1]:.0f} deg. Here: {in_digits(found[0], '.1f')} to "
        f"{found[1]:.1f} deg, {_beyond(found, known, 'deg', '.1f')}; it is at its limit for "
        f"{100.0 * (held.run.figures['saturated_share'] or 0.0):.1f} % of the run."
    )


# ---- settings ------------------------------------------------------------------------------------------------------


def _by_law(study: PathFollowingStudy) -> dict[str, list[FollowingRun]]:
    laws: dict[str, list[FollowingRun]] = {}
    for run in study.cases[0].band:
        laws.setdefault(run.joints, []).append(run)
    return laws


def _law(runs: Sequence[FollowingRun]) -> str:
    run = runs[0]
    start = f"smooth start of {run.ramp:g} s" if run.ramp else "no smooth start"
    bandwidths = " and ".join(f"{each.offset_bandwidth:g}" for each in runs)
    made = f"Time step {run.dt:g} s, {start}, bandwidth {bandwidths} rad/s."
    return f"{run.joints}: {JOINTS.get(run.joints, '')} {made}"


# ---- findings ------------------------------------------------------------------------------------------------------


def _way_there(study: PathFollowingStudy) -> str:
    runs = [case.run for case in study.cases]
    there = [run.figures for run in runs if run.converged]
    if not there:
        return f"With {runs[0].name}, none of the {len(runs)} trials converges."
    times = _range([each["convergence_time"] or 0.0 for each in there], ".0f")
    distances = _range([each["convergence_distance"] or 0.0 for each in there], ".2f")
    return (
        f"With {runs[0].name}, {_share(len(there), len(runs))} trials converge, that is, their cycle-mean error stays "
        f"within 0.1 m for a cycle: after {times} s and {distances} m along the path."
    )


def _kept(study: PathFollowingStudy, runs: Sequence[FollowingRun]) -> str:
    """Whether the cycle-mean error stays small in the last third of every trial, and where not."""
    limit = study.settings.accepted_error
    outside = [
        (case.figure, run)
        for case, run in zip(study.cases, runs, strict=True)
        if run.last_third_largest is None or run.last_third_largest > limit
    ]
    largest = max(run.last_third_largest or 0.0 for run in runs)
    kept = f"With {runs[0].name}, the cycle-mean error stays within {_cm(limit)} over the last third"
    if not outside:
        return f"{kept} in all {len(runs)} trials (at most {_cm(largest)})."
    which = f" (not in {_figs([figure for figure, _ in outside])})" if len(outside) < len(runs) else ""
    rms = max(run.last_third_rms or 0.0 for _, run in outside)
    return (
        f"{kept} in {_share(len(runs) - len(outside), len(runs))} trials{which}: it is up to {_cm(largest)}, "
        f"with an rms of up to {_cm(rms)}."
    )


def _errors(study: PathFollowingStudy) -> Iterator[str]:
    ways = [score for score in following_scores(study) if score.n_fitted is None]
    best = min(null_predictions(study), key=lambda prediction: prediction.overall)
    chosen, rest = ways[0], [score.overall for score in ways[1:]]
    yield (
        f"Mean error of the forward velocity over Table 2: {chosen.overall:.1f} % ({chosen.name}), "
        f"{_range(rest, '.0f')} % (the other ways); the best model without physics "
        f"({best.name}, {best.n_fitted} numbers fitted to Table 1): {best.overall:.1f} %."
    )
    outside = [case.figure for case in study.cases if not _in_band(case)]
    n_inside = len(study.cases) - len(outside)
    yield (
        f"The measured speed lies in the band of {_share(n_inside, len(study.cases))} trials"
        + (f"; not in that of {_figs(outside)}." if outside and n_inside else ".")
    )
    for group, error in zip(study.settings.groups, chosen.by_group, strict=True):
        here = [case for case in study.cases if case.group == group]
        changes = [100.0 * (case.run.forward_velocity / case.measured.forward_velocity - 1.0) for case in here]
        yield (
            f"{_plain(group.name).capitalize()}: simulated speeds {_range(changes, '+.1f')} % from the measured ones, "
            f"mean error {error:.1f} %."
        )


def _in_band(case: FollowingCase) -> bool:
    speeds = [run.forward_velocity for run in case.band]
    return min(speeds) <= case.measured.forward_velocity <= max(speeds)


def _changed_by_the_loop(study: PathFollowingStudy) -> Iterator[str]:
    for group in study.settings.groups:
        here = [case for case in study.cases if case.group == group]
        changes = [_change(case, case.run) for case in here]
        means = [_change(case, case.cycle_mean) for case in here]
        swings = [math.degrees(case.run.offset_swing) for case in here]
        known = [change for change in changes if change is not None]
        known_means = [change for change in means if change is not None]
        if known and known_means:
            yield (
                f"Closing the loop on the raw heading adds an offset that swings by ±{_range(swings, '.1f')} deg to "
                f"{_plain(group.name)}, and changes its steady velocity by {_range(known, '+.0f')} %; with the "
                f"cycle-mean heading, by {_range(known_means, '+.0f')} %."
            )


def _change(case: FollowingCase, run: FollowingRun) -> float | None:
    return None if run.steady_velocity is None else 100.0 * (run.steady_velocity / case.free_velocity - 1.0)


def _fin(study: PathFollowingStudy) -> Iterator[str]:
    changes = fin_changes(study)
    for kind in dict.fromkeys(change.with_fin.group.gait for change in changes):
        here = [change for change in changes if change.with_fin.group.gait == kind]
        yield (
            f"In path following the fin makes {GAIT_WORDS[kind]} faster by "
            f"{_range([change.measured_velocity for change in here], '.0f')} % as measured; simulated: "
            f"{_range([change.simulated_velocity for change in here], '.0f')} %, over the band "
            f"{_range([end for change in here for end in change.band_velocity], '.0f')} %."
        )
    for change in changes:
        for what in change.misprints:
            printed, value = getattr(change, f"printed_{what}"), getattr(change, f"measured_{what}")
            yield (
                f"Misprint in the paper's Table 2: {change.with_fin.group.name}, case {change.with_fin.measured.case}, "
                f"change of {what} printed {printed:+.2f} %, recomputed from the table {value:+.2f} %."
            )


def _costs(study: PathFollowingStudy) -> Iterator[str]:
    """Measured energy per meter without and with the fin, gait by gait."""
    costs = {cost.group: cost for cost in meter_costs(study)}
    for gait in dict.fromkeys(group.gait for group in study.settings.groups):
        pair = {group.has_fin: costs[group.name] for group in study.settings.groups if group.gait == gait}
        if len(pair) == 2:
            before, after = pair[False].measured_mean, pair[True].measured_mean
            verdict = "saves" if after < before else "does not save"
            yield (
                f"By the paper's own numbers a meter of {GAIT_WORDS[gait]} takes {before:.0f} J without the fin and "
                f"{after:.0f} J with it (means of Table 2, electrical, above idle): per meter the fin {verdict} energy."
            )


# ---- numbers as texts ----------------------------------------------------------------------------------------------


def _plain(group: str) -> str:
    """A group's name within a sentence."""
    return group.replace(",", "")


def _share(part: int, whole: int) -> str:
    return f"all {whole}" if part == whole else f"none of the {whole}" if part == 0 else f"{part} of the {whole}"


def _figs(numbers: Sequence[int]) -> str:
    """Numbers of figures, those in a row as from-to."""
    rows: list[list[int]] = []
    for number in numbers:
        if rows and rows[-1][-1] == number - 1:
            rows[-1].append(number)
        else:
            rows.append([number])
    shown = [f"{row[0]}" if len(row) == 1 else f"{row[0]} to {row[-1]}" for row in rows]
    listed = " and ".join((", ".join(shown[:-1]), shown[-1])) if len(shown) > 1 else shown[0]
    return f"{'Fig.' if len(numbers) == 1 else 'Figs.'} {listed}"


def _range(values: Sequence[float], form: str) -> str:
    low, high = in_digits(min(values), form), in_digits(max(values), form)
    return low if low == high else f"{low} to {high}"


def _cm(length: float | None) -> str:
    return "unknown" if length is None else f"{100.0 * length:.2g} cm"


def _beyond(found: tuple[float, float], known: tuple[float, float], unit: str, form: str = ".2g") -> str:
    """By how much a range leaves another one."""
    below, above = known[0] - found[0], found[1] - known[1]
    beyond = [f"{format(by, form)} {unit} {where}" for by, where in ((below, "below"), (above, "above")) if by > 0.0]
    return f"which is {' and '.join(beyond)} the published range" if beyond else "which is within the published range"
