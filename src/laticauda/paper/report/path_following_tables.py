"""The path-following study as tables: Table 2 row by row, every run, what the loop changes, the fin, errors, costs."""

import math

from laticauda.paper.following_run import FollowingRun
from laticauda.paper.path_following import FollowingCase, PathFollowingStudy
from laticauda.paper.table2 import fin_changes, following_scores, meter_costs
from laticauda.reports.tables import Cell, Column, Table

CASE = (Column(name="group"), Column(name="case"))


def path_following_tables(study: PathFollowingStudy) -> tuple[Table, ...]:
    """All tables of the study.

    Args:
        study: What `run_path_following` returned.
    """
    return (
        trial_table(study),
        table2(study),
        loop_table(study),
        prediction_table(study),
        fin_change_table(study),
        cost_table(study),
        run_table(study),
    )


def trial_table(study: PathFollowingStudy) -> Table:
    """The figures of the chosen runs, a row per trial.

    Args:
        study: What `run_path_following` returned.
    """
    rows = [(*_case(case), case.figure, *_start(case), *_figures(case.run)) for case in study.cases]
    return Table(
        name="following-trials",
        grouped=True,
        caption=f"The {len(rows)} trials with {study.cases[0].run.name}. Errors are distances from the path averaged "
        "over the gait cycle: converged when the mean stays within 0.1 m for a whole cycle; the overshoot is the "
        "largest mean on the other side; rms error and ripple count from convergence on. The last third of the run "
        "stands beside them, because a slow swing about the path can pass as converged.",
        columns=(*CASE, Column(name="figure"), *START, *FIGURES),
        rows=tuple(rows),
    )


def table2(study: PathFollowingStudy) -> Table:
    """Table 2: measured and simulated speeds, with the band.

    Args:
        study: What `run_path_following` returned.
    """
    rows: list[tuple[Cell, ...]] = []
    for case in study.cases:
        measured, velocity = case.measured.forward_velocity, case.run.forward_velocity
        band = [run.forward_velocity for run in case.band]
        row: list[Cell] = [*_case(case), *_start(case), measured, velocity, 100.0 * (velocity / measured - 1.0)]
        row += [min(band), max(band), min(band) <= measured <= max(band)]
        row += [case.measured.mean_power, case.run.mechanical_power]
        rows.append(tuple(row))
    settings = study.settings
    laws = ", ".join(settings.joint_laws)
    bandwidths = " and ".join(f"{bandwidth:g}" for bandwidth in settings.offset_bandwidths)
    return Table(
        name="table2",
        grouped=True,
        caption=f"Table 2: measured and simulated forward velocity v, equation (5), over {settings.duration:g} s or "
        f"{settings.distance:g} m in x. Simulated: {study.cases[0].run.name}. The band is the range over the joint "
        f"laws {laws} and bandwidths of {bandwidths} rad/s. The powers are not comparable: the measured one is "
        "electrical, above idle; the simulated one is mechanical.",
        columns=(
            *CASE,
            *START,
            Column(name="measured: v [m/s]", form=".4f"),
            Column(name="simulated: v [m/s]", form=".4f"),
            Column(name="error [%]", form="+.1f"),
            Column(name="band: lowest v [m/s]", form=".4f"),
            Column(name="band: highest v [m/s]", form=".4f"),
            Column(name="measured v in the band"),
            Column(name="measured: electrical power [W]", form=".2f"),
            Column(name="simulated: mechanical power [W]", form=".1f"),
        ),
        rows=tuple(rows),
    )


def loop_table(study: PathFollowingStudy) -> Table:
    """What closing the loop does to gait and speed, with the raw and with the mean heading.

    Args:
        study: What `run_path_following` returned.
    """
    rows: list[tuple[Cell, ...]] = []
    for case in study.cases:
        row: list[Cell] = [*_case(case), case.free_velocity]
        for run in (case.run, case.cycle_mean):
            steady = run.steady_velocity
            change = None if steady is None else 100.0 * (steady / case.free_velocity - 1.0)
            row += [run.forward_velocity, steady, change, math.degrees(run.offset_swing), run.last_third_largest]
        rows.append(tuple(row))
    found = [
        column
        for heading in ("raw", "cycle mean")
        for column in (
            Column(name=f"{heading}: v [m/s]", form=".4f"),
            Column(name=f"{heading}: steady v [m/s]", form=".4f"),
            Column(name=f"{heading}: change from unsteered [%]", form="+.1f"),
            Column(name=f"{heading}: swing of the offset [deg]", form=".1f"),
            Column(name=f"{heading}: largest error in the last third [m]", form=".3f"),
        )
    ]
    return Table(
        name="following-loop",
        grouped=True,
        caption="What closing the loop changes: the same gait unsteered, steered by the raw heading, and steered by "
        "its mean over the gait cycle. Steady v leaves the start out; the swing is the amplitude of the offset that is "
        "asked for in the last third, which every joint gets on top of its gait.",
        columns=(*CASE, Column(name="unsteered: steady v [m/s]", form=".4f"), *found),
        rows=tuple(rows),
    )


def prediction_table(study: PathFollowingStudy) -> Table:
    """Mean errors by group and overall: all ways to simulate, then the null models.

    Args:
        study: What `run_path_following` returned.
    """
    rows: list[tuple[Cell, ...]] = [
        (
            score.name if score.n_fitted is None else f"null model: {score.name}",
            score.n_fitted or 0,
            *score.by_group,
            score.overall,
        )
        for score in following_scores(study)
    ]
    groups = [Column(name=f"{group.name} [%]", form=".1f") for group in study.settings.groups]
    return Table(
        name="following-errors",
        caption="Mean absolute percentage error of the forward velocity over Table 2. Nothing is fitted to these rows. "
        "The null models know no physics and are fitted to Table 1; the mean stride is the constant stride with the "
        "arithmetic instead of the geometric mean of its strides.",
        columns=(
            Column(name="predictor of v"),
            Column(name="numbers fitted to Table 1"),
            *groups,
            Column(name="all rows [%]", form=".1f"),
        ),
        rows=tuple(rows),
    )


def fin_change_table(study: PathFollowingStudy) -> Table:
    """What the fin changes: recomputed from the table, simulated, and as printed.

    Args:
        study: What `run_path_following` returned.
    """
    rows: list[tuple[Cell, ...]] = []
    for change in fin_changes(study):
        row: list[Cell] = [change.with_fin.group.name.split(",")[0], change.with_fin.measured.case]
        row += [change.measured_velocity, change.simulated_velocity, *change.band_velocity, change.printed_velocity]
        row += [change.measured_power, change.simulated_power, change.printed_power, ", ".join(change.misprints)]
        rows.append(tuple(row))
    return Table(
        name="following-fin",
        grouped=True,
        caption="What the fin changes, in percent of the robot without it: recomputed from the speeds and powers of "
        "Table 2, simulated, and as the paper prints it. Cases of the same number start from different places, with "
        "and without the fin.",
        columns=(
            Column(name="gait"),
            Column(name="case"),
            Column(name="measured: v [%]", form="+.2f"),
            Column(name="simulated: v [%]", form="+.1f"),
            Column(name="band: lowest [%]", form="+.1f"),
            Column(name="band: highest [%]", form="+.1f"),
            Column(name="printed: v [%]", form="+.2f"),
            Column(name="measured: electrical power [%]", form="+.2f"),
            Column(name="simulated: mechanical power [%]", form="+.0f"),
            Column(name="printed: electrical power [%]", form="+.2f"),
            Column(name="misprint"),
        ),
        rows=tuple(rows),
    )


def cost_table(study: PathFollowingStudy) -> Table:
    """Energy per meter: of every trial, and the mean of each group.

    Args:
        study: What `run_path_following` returned.
    """
    rows: list[tuple[Cell, ...]] = []
    for cost in meter_costs(study):
        trials = zip(cost.measured, cost.simulated, strict=True)
        rows += [(cost.group, f"case {i}", *pair) for i, pair in enumerate(trials, start=1)]
        rows.append((cost.group, "mean", cost.measured_mean, cost.simulated_mean))
    return Table(
        name="following-joules",
        grouped=True,
        caption="Energy per meter, power / forward velocity. The two columns are not comparable: the measured power is "
        "electrical, above idle; the simulated one is mechanical.",
        columns=(
            Column(name="group"),
            Column(name="trial"),
            Column(name="measured: electrical [J/m]", form=".0f"),
            Column(name="simulated: mechanical [J/m]", form=".0f"),
        ),
        rows=tuple(rows),
    )


def run_table(study: PathFollowingStudy) -> Table:
    """Every steered run of the study, a row each.

    Args:
        study: What `run_path_following` returned.
    """
    rows: list[tuple[Cell, ...]] = []
    for case in study.cases:
        rows += [(*_case(case), *_how(run), *_figures(run)) for run in (*case.band, case.cycle_mean)]
    held = study.held_out
    rows.append(("held out", 1, *_how(held.run), *_figures(held.run)))
    heads = ("joints", "bandwidth [rad/s]", "heading", "time step [s]", "ramp [s]", "ended by", "v [m/s]")
    heads += ("path speed [m/s]", "steady v [m/s]", "mechanical power [W]", "mechanical [J/m]")
    heads += ("swing of the offset [deg]",)
    return Table(
        name="following-runs",
        caption="Every steered run.",
        columns=(*CASE, *(Column(name=head) for head in heads), *FIGURES),
        rows=tuple(rows),
    )


# ---- cells that tables have in common ----------------------------------------------------------------------------

START = (Column(name="start: p_y [m]", form=".4f"), Column(name="start: heading [deg]", form=".2f"))
FIGURES = (
    Column(name="run [s]", form=".1f"),
    Column(name="converged after [s]", form=".1f"),
    Column(name="converged after [m]", form=".2f"),
    Column(name="overshoot [m]", form=".3f"),
    Column(name="rms error [m]", form=".3f"),
    Column(name="ripple [m]", form=".3f"),
    Column(name="offset at its limit [%]", form=".1f"),
    Column(name="last third: mean error [m]", form="+.4f"),
    Column(name="last third: rms error [m]", form=".4f"),
    Column(name="last third: largest error [m]", form=".4f"),
)


def _case(case: FollowingCase) -> tuple[Cell, ...]:
    return case.group.name, case.measured.case


def _start(case: FollowingCase) -> tuple[Cell, ...]:
    return case.measured.initial_cross_track_error, round(math.degrees(case.measured.initial_heading), 9)


def _how(run: FollowingRun) -> tuple[Cell, ...]:
    made = (run.joints, run.offset_bandwidth, run.heading_estimate, run.dt, run.ramp, run.reached)
    found = (run.forward_velocity, run.path_speed, run.steady_velocity, run.mechanical_power, run.joules_per_meter)
    return *made, *found, math.degrees(run.offset_swing)


def _figures(run: FollowingRun) -> tuple[Cell, ...]:
    names = ("convergence_time", "convergence_distance", "overshoot", "steady_error", "ripple")
    share = run.figures["saturated_share"]
    return (
        run.duration,
        *(run.figures[name] for name in names),
        None if share is None else 100.0 * share,
        run.figures["last_third_error"],
        run.last_third_rms,
        run.last_third_largest,
    )
