"""The path-following study as tables: Table 2 row by row, every run, what the loop changes, the fin, errors, costs."""

import math
from collections.abc import Iterable, Iterator

from laticauda.paper.claims.quantities import band_gains
from laticauda.paper.measured import percent_change
from laticauda.paper.path_following import FollowingCase, FollowingRun, PathFollowingStudy
from laticauda.paper.report.chapter import Row, degrees, error_rows, fin_row
from laticauda.paper.scores import FinGain, fin_gains, meter_costs


def path_following_tables(study: PathFollowingStudy) -> dict[str, Iterable[Row]]:
    """All tables of the study, by name.

    Args:
        study: What `run_path_following` returned.
    """
    cases = study.cases
    return {
        "following-trials": [
            _case(case) | {"figure": case.figure} | _start(case) | _figures(case.run) for case in cases
        ],
        "table2": [_table2(case) for case in cases],
        "following-loop": [_loop(case) for case in cases],
        "following-errors": error_rows(study, "numbers fitted to Table 1", {}),
        "following-fin": [_fin(gain) for gain in fin_gains(cases)],
        "following-joules": _joules(study),
        "following-runs": _runs(study),
    }


def _case(case: FollowingCase) -> Row:
    return {"group": case.group.name, "case": case.measured.case}


def _start(case: FollowingCase) -> Row:
    heading = degrees(case.measured.initial_heading)
    return {"start: p_y [m]": case.measured.initial_cross_track_error, "start: heading [deg]": heading}


def _figures(run: FollowingRun) -> Row:
    figures = run.figures
    share = figures["saturated_share"]
    return {
        "run [s]": run.duration,
        "converged after [s]": figures["convergence_time"],
        "converged after [m]": figures["convergence_distance"],
        "overshoot [m]": figures["overshoot"],
        "rms error [m]": figures["steady_error"],
        "ripple [m]": figures["ripple"],
        "offset at its limit [%]": None if share is None else 100.0 * share,
        "last third: mean error [m]": figures["last_third_error"],
        "last third: rms error [m]": run.last_third_rms,
        "last third: largest error [m]": run.last_third_largest,
    }


def _table2(case: FollowingCase) -> Row:
    measured, band = case.measured.forward_velocity, [run.forward_velocity for run in case.band]
    return {
        **_case(case),
        **_start(case),
        "measured: v [m/s]": measured,
        "simulated: v [m/s]": case.run.forward_velocity,
        "error [%]": percent_change(measured, case.run.forward_velocity),
        "band: lowest v [m/s]": min(band),
        "band: highest v [m/s]": max(band),
        "measured v in the band": case.is_in_band,
        "measured: electrical power [W]": case.measured.mean_power,
        "simulated: mechanical power [W]": case.run.mechanical_power,
    }


def _loop(case: FollowingCase) -> Row:
    row = _case(case) | {"unsteered: steady v [m/s]": case.free_velocity}
    for heading, run in (("raw", case.run), ("cycle mean", case.cycle_mean)):
        row |= {
            f"{heading}: v [m/s]": run.forward_velocity,
            f"{heading}: steady v [m/s]": run.steady_velocity,
            f"{heading}: change from unsteered [%]": case.change_by_the_loop(run),
            f"{heading}: swing of the offset [deg]": math.degrees(run.offset_swing),
            f"{heading}: largest error in the last third [m]": run.last_third_largest,
        }
    return row


def _fin(gain: FinGain[FollowingCase]) -> Row:
    band = band_gains(gain)
    velocity: Row = {"simulated: v [%]": gain.simulated(lambda case: case.run.forward_velocity)}
    velocity |= {"band: lowest [%]": min(band), "band: highest [%]": max(band)}
    power = {"simulated: mechanical power [%]": gain.simulated(lambda case: case.run.mechanical_power)}
    return fin_row(gain.measured, {}, velocity, power)


def _joules(study: PathFollowingStudy) -> Iterator[Row]:
    for cost in meter_costs(study):
        trials = [(f"case {i}", *pair) for i, pair in enumerate(zip(cost.measured, cost.simulated, strict=True), 1)]
        for trial, measured, simulated in (*trials, ("mean", cost.measured_mean, cost.simulated_mean)):
            yield {
                "group": cost.group,
                "trial": trial,
                "measured: electrical [J/m]": measured,
                "simulated: mechanical [J/m]": simulated,
            }


def _runs(study: PathFollowingStudy) -> Iterator[Row]:
    runs = [(_case(case), run) for case in study.cases for run in (*case.band, case.cycle_mean)]
    for names, run in (*runs, ({"group": "held out", "case": 1}, study.held_out.run)):
        yield {
            **names,
            "joints": run.joints,
            "bandwidth [rad/s]": run.offset_bandwidth,
            "heading": run.heading_estimate,
            "time step [s]": run.dt,
            "ramp [s]": run.ramp,
            "ended by": run.reached,
            "v [m/s]": run.forward_velocity,
            "path speed [m/s]": run.path_speed,
            "steady v [m/s]": run.steady_velocity,
            "mechanical power [W]": run.mechanical_power,
            "mechanical [J/m]": run.joules_per_meter,
            "swing of the offset [deg]": math.degrees(run.offset_swing),
            **_figures(run),
        }
