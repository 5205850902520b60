"""What was run beyond the paper as tables: the cross current, the curved path, open-loop turning."""

import math

from laticauda.paper.beyond import BeyondStudy
from laticauda.reports.tables import Cell, Column, Table


def beyond_tables(study: BeyondStudy) -> tuple[Table, ...]:
    """All tables of the study.

    Args:
        study: What `run_beyond` returned.
    """
    return drift_table(study), curved_table(study), turning_table(study)


def drift_table(study: BeyondStudy) -> Table:
    """The cross current, law by law.

    Args:
        study: What `run_beyond` returned.
    """
    rows: list[tuple[Cell, ...]] = []
    for run in study.drift:
        law = run.law
        numbers = (run.mean_error, run.rms_error, run.largest_error, run.final_error, math.degrees(run.trial.sideslip))
        row: list[Cell] = [
            law.name,
            law.guidance.look_ahead_distance,
            law.gain,
            getattr(law.guidance, "integral_gain", None),
        ]
        rows.append((*row, *numbers, run.geometric_error, run.trial.forward_velocity, run.holds))
    limit = 100.0 * study.settings.drift.tolerance
    return Table(
        name="beyond-cross-current",
        caption="Cross current: the cycle-mean cross-track error e. Sideslip is course minus heading. Delta "
        "tan(sideslip) is what line of sight must keep, as it heads for the point that lies Delta ahead; the integral "
        f"takes it off. A law holds the path if its mean error over the last third is below {limit:g} cm.",
        columns=(
            Column(name="law"),
            Column(name="look-ahead distance Delta [m]"),
            Column(name="gain [-]"),
            Column(name="integral gain [m/s]"),
            Column(name="mean e, last third [m]", form="+.3f"),
            Column(name="rms of e, last third [m]", form=".3f"),
            Column(name="largest e [m]", form="+.3f"),
            Column(name="e at the end [m]", form="+.3f"),
            Column(name="sideslip [deg]", form="+.1f"),
            Column(name="Delta tan(sideslip) [m]", form="+.3f"),
            Column(name="v [m/s]", form=".3f"),
            Column(name="holds the path"),
        ),
        rows=tuple(rows),
    )


def curved_table(study: BeyondStudy) -> Table:
    """The curved path, swimmer by swimmer.

    Args:
        study: What `run_beyond` returned.
    """
    rows: list[tuple[Cell, ...]] = []
    for run in study.curved:
        trial = run.trial
        to_end = study.settings.curved.path.length if run.reached_end else None
        rows.append(
            (
                run.swimmer.name,
                run.rms,
                run.largest,
                run.reached_end,
                trial.duration,
                None if to_end is None else to_end / trial.duration,
                trial.path_speed,
                trial.mechanical_power,
            )
        )
    return Table(
        name="beyond-curved-path",
        caption="The curved path: the cycle-mean cross-track error, and how fast the swimmer came to the end. Progress "
        "is the length of the curve / time; the path speed has the swing across the course in it.",
        columns=(
            Column(name="swimmer"),
            Column(name="rms of the mean error [m]", form=".3f"),
            Column(name="largest mean error [m]", form=".3f"),
            Column(name="reached the end"),
            Column(name="after [s]", form=".1f"),
            Column(name="progress [m/s]", form=".3f"),
            Column(name="path speed [m/s]", form=".3f"),
            Column(name="mechanical power [W]", form=".2f"),
        ),
        rows=tuple(rows),
    )


def turning_table(study: BeyondStudy) -> Table:
    """Open-loop turning, offset by offset.

    Args:
        study: What `run_beyond` returned.
    """
    rows: list[tuple[Cell, ...]] = []
    for curve in study.turning:
        columns = (curve.turning_rate, curve.radius, curve.path_speed, curve.mechanical_power)
        for offset, rate, radius, speed, power in zip(study.settings.turning.offsets, *columns, strict=True):
            found = (
                math.degrees(rate),
                float(radius),
                float(radius) / curve.swimmer.length,
                float(speed),
                float(power),
            )
            rows.append((curve.swimmer.name, round(math.degrees(offset), 9), *found))
    return Table(
        name="beyond-turning",
        grouped=True,
        caption="Open-loop turning: turning rate (slope of the cycle-mean heading over the steady part), radius (path "
        "speed / turning rate; also in lengths of the robot with its fin), path speed (length of the path / time) and "
        "mechanical power.",
        columns=(
            Column(name="swimmer"),
            Column(name="offset [deg]"),
            Column(name="turning rate [deg/s]", form=".2f"),
            Column(name="radius [m]", form=".2f"),
            Column(name="radius in robot lengths [-]", form=".2f"),
            Column(name="path speed [m/s]", form=".3f"),
            Column(name="mechanical power [W]", form=".2f"),
        ),
        rows=tuple(rows),
    )
