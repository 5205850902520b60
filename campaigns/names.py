"""Does every name of a body and its gait work wherever names are taken?

    python campaigns/names.py           # the stored table in words
    python campaigns/names.py --write   # run everything anew (some minutes)

60 numbers of one robot with ten modules that all differ and of its gait: lengths, masses, sections,
centers of mass, an inertia, a drag of some modules, the joints' stiffness and damping, amplitudes
and leads of single joints, and the wave. Each name goes through every door:

swept       alone to another value, in one sweep; the speed is that of a single `swim` of the changed scenario
slope       of the speed (pd joints, forward in time) and of the net power (prescribed joints, backward
            in time), against differences
optimized   all 60 at once along the slopes of the cost of transport, and swum again
identified  alone from a simulated path with known truth; and whether the program says of a path
            with prescribed joints which names it does not depend on
filed       in a scenario file, and a robot file or the gait in it, that are read back
flags       of `laticauda sweep`, `optimize` and `identify`, as people type it
exported    as a variable of an FMU, with which it swims as `swim` does: of the same name, or, for what an FMU has
            in single parts only, of each part's; what an FMU does not have is said

Differences are central, of the steps h and h/2, extrapolated once (Richardson), with h 2e-4 of the value,
of a lead 2e-4 rad: quadratic drag bends in its second derivative wherever a velocity changes its sign, so
that larger steps that cross such a moment are worse (1e-5 at 3e-3), and rounding of a figure is divided by
steps that are large enough for it to stay at 1e-9 of most slopes.

Last answer (2026-11-30): swept as swum alone to 6e-16, by flags to 7e-16; slopes as differences to 2e-7;
optimized from a cost of transport of 0.750 to 0.297, swum again to the same digits; 57 identified alone to
1e-12, the three numbers of the commanded wave refused; 11 of joints' skins said to have no effect; all filed
and exported, 8 ranges and tapers part by part, 4 amplitudes as shares, as `swim` to 6e-15.
"""

import argparse
import csv
import json
import math
import shlex
import sys
import tempfile
import warnings
from collections.abc import Callable, Mapping, Sequence
from contextlib import redirect_stdout
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from _rows import stored

import laticauda as lc
from laticauda.cli.app import main as run_program
from laticauda.cli.vary import spell_parameter
from laticauda.connect import export_fmu
from laticauda.identify import Fit, Unknown, fit, from_trial
from laticauda.models.simulate import change_parameters, compute_sensitivities, value_of
from laticauda.models.simulate.numbers import list_parameters
from laticauda.robot import to_toml
from laticauda.scenarios import load_scenario, save_scenario
from laticauda.studies import Optimization, Rows, Sweep, open_sweep, optimize, run_sweep
from laticauda.values import InfeasibleWarning, display_unit

TABLE = Path(__file__).with_suffix(".csv")
TOGETHER = Path(__file__).with_name("names_together.csv")
N_MODULES = 10
DURATION = 2.0
"""Duration of a trial [s]."""
DT = 0.01
"""Time step, fixed so that differences are of the same steps [s]."""
RAMP = 0.5
"""Duration of the smooth start [s]."""
GAIT = lc.eel_like(amplitude=0.5, frequency=6.0, phase_shift=0.7, offset=0.02)
ANGLES = ("amplitude", "frequency", "phase_shift", "offset")
"""Numbers of the wave, which people type in degrees."""
CHANGE = 0.03
"""By which share of its value, or how much of a lead or an angle, a number is changed [-], [rad]."""
STEPS = (2e-4, -2e-4, 1e-4, -1e-4)
"""Steps of differences, likewise."""
WIDTH = 0.15
"""Half the width of the ranges of an optimization, likewise."""
BUDGET = 1500
"""Points of the optimization."""
NO_EFFECT = "has no effect on what was measured"
"""What a fit says of an unknown on which nothing depends."""
TOGETHER_IDENTIFIED = (
    "robot.module[0].mass",
    "robot.module[9].length",
    "robot.module[4:].section.half_height",
    "robot.joint[2].stiffness",
    "robot.joint[3:].damping",
    "gait.amplitude[3]",
    "gait.phase[5]",
    "water.normal_drag",
)
"""Names that are identified together: few enough for the paths of two trials to tell them apart."""


def name_values() -> dict[str, float]:
    """Return the 60 names with the values that the robot has: no two parts are alike."""
    values: dict[str, float] = {}
    for i in range(N_MODULES):
        values[f"robot.module[{i}].length"] = 0.12 + 0.003 * i
        values[f"robot.module[{i}].mass"] = 0.75 + 0.02 * i
    for i in range(4):
        values[f"robot.module[{i}].section.half_height"] = 0.05 + 0.002 * i
    values["robot.module[4:].section.half_height"] = 0.058
    values["robot.taper.section.half_width.tail"] = 0.04
    values["robot.taper.section.half_width.head"] = 0.05
    values["robot.taper.section.half_width.bulge"] = 0.005
    for i in range(5):
        values[f"robot.module[{i}].center"] = 0.004 + 0.001 * i
    values["robot.module[9].inertia"] = 0.002
    values["robot.module[::3].normal_drag"] = 1.6
    for i in range(6):
        values[f"robot.joint[{i}].stiffness"] = 0.2 + 0.05 * i
    values["robot.joint[6:].stiffness"] = 0.5
    for i in range(3):
        values[f"robot.joint[{i}].damping"] = 0.02 + 0.01 * i
    values["robot.joint[3:].damping"] = 0.05
    for i in range(4):
        values[f"gait.amplitude[{i}]"] = 0.3 + 0.04 * i
    for i in range(1, 6):
        values[f"gait.phase[{i}]"] = 0.02 * i
    values["gait.phase[6:]"] = 0.0
    values["gait.frequency"] = GAIT.frequency
    values["gait.phase_shift"] = GAIT.phase_shift
    values["gait.offset"] = GAIT.offset
    values["water.normal_drag"] = 1.75
    return values


VALUES = name_values()
NAMES = tuple(VALUES)


def make_scenario(joints: str = "pd") -> lc.Scenario:
    """Return the robot that has all these numbers, with its gait.

    Args:
        joints: Law of the joints; those of `pd` have soft gains, so that the skin matters.
    """
    scenario = lc.build_scenario(
        lc.load_robot("mamba", N_MODULES), GAIT, DURATION, joints=joints, dt=DT, ramp=RAMP
    )
    soft = {
        "robot.joint.actuator.proportional_gain": 8.0,
        "robot.joint.actuator.derivative_gain": 0.8,
    }
    return change_parameters(scenario, soft | VALUES)


SCENARIO = make_scenario()
PRESCRIBED = make_scenario("prescribed")
PARAMETERS = list_parameters(SCENARIO)


def size_of(name: str) -> float:
    """Return what a share of a name's value is taken of: the value; 1 for a lead or an offset."""
    if name.startswith(("gait.phase[", "gait.offset")):
        return 1.0
    return VALUES[name]


CHANGED = {name: VALUES[name] + CHANGE * size_of(name) for name in NAMES}
"""Values to which numbers are changed."""
BOUNDS = {
    name: (VALUES[name] - WIDTH * size_of(name), VALUES[name] + WIDTH * size_of(name))
    for name in NAMES
}


@dataclass(frozen=True)
class Row:
    """What a name did at every door; errors are relative."""

    name: str
    unit: str
    """Unit; "" for a pure number."""
    value: float
    changed: float
    """Value to which it is swept."""
    speed_change: float
    """By how much that changes the speed [-]."""
    sweep_error: float
    """By how much the sweep's speed differs from that of a single trial [-]."""
    speed_slope: float
    """Slope of the speed, pd joints [m/s per unit]."""
    speed_slope_error: float
    power_slope: float
    """Slope of the net power, prescribed joints [W per unit]."""
    power_slope_error: float
    """Error of this slope; 0 where slope and difference are both zero."""
    optimized: float
    """Its value in the best of all."""
    recovered_error: float
    """Error of the value that is identified from pd joints [-]."""
    unseen: str
    """Whether a fit to a path with prescribed joints says that it has no effect there."""
    filed: str
    """Whether it is read back from files as it was."""
    sweep_flag: str
    """Name as people type it for `sweep` and `optimize`."""
    sweep_flag_error: float
    """By how much the speed of the command's trial differs from that of a single trial [-]."""
    optimize_flag: str
    """Whether `laticauda optimize` found its range."""
    identify_flag: str
    """Whether `laticauda identify` found its value, and wrote it to a scenario file."""
    exported: str
    """Whether an FMU has a variable of this name, or which others stand for it."""
    export_error: float
    """By how much the FMU with the changed number differs from `swim` in where the head is; -1: not exported."""


@dataclass(frozen=True)
class Figure:
    """A number about all names together."""

    what: str
    value: float


def swum_speed(scenario: lc.Scenario) -> float:
    """Return the speed of a single trial [m/s]."""
    return float(lc.swim(scenario).forward_velocity)


def one_changed_each() -> dict[str, list[float]]:
    """Return columns of 60 points; in each, one number has another value."""
    return {
        name: [CHANGED[name] if row == column else VALUES[name] for row in range(len(NAMES))]
        for column, name in enumerate(NAMES)
    }


def sweep_all(folder: Path) -> np.ndarray:
    """Return the speed of every point of one sweep in which one number changes at a time [m/s]."""
    sweep = Sweep(scenario=SCENARIO, points=Rows(values=one_changed_each()))
    results = run_sweep(sweep, folder / "sweep", threads=1)
    return results.forward_velocity.to_numpy()


def compare_slopes(scenario: lc.Scenario, figure: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the slopes of a figure, and their errors against differences, relative to each slope.

    Args:
        scenario: The scenario.
        figure: Name of the figure.
    """
    slopes = compute_sensitivities([scenario], names=NAMES, figures=[figure], threads=1)
    columns: dict[str, list[float]] = {name: [] for name in NAMES}
    for changed_name in NAMES:
        for step in STEPS:
            for name in NAMES:
                change = step * size_of(name) if name == changed_name else 0.0
                columns[name].append(VALUES[name] + change)
    swims = lc.swim_many(scenario, columns=columns, threads=1)
    values = np.asarray(getattr(swims, figure)).reshape(len(NAMES), len(STEPS))
    differences = extrapolate_differences(values) / [size_of(name) for name in NAMES]
    found = slopes.jacobian[0, 0]
    off = np.abs(found - differences)
    is_zero = (found == 0.0) & (off < 1e-9 * np.abs(found).max())
    errors = np.divide(off, np.abs(found), out=np.full(off.shape, np.inf), where=found != 0.0)
    return found, np.where(is_zero, 0.0, errors)


def extrapolate_differences(values: np.ndarray) -> np.ndarray:
    """Return slopes from the values of a figure at all `STEPS`, per size of the number.

    Args:
        values: One row per name.
    """
    wide, narrow = (
        (values[:, i] - values[:, i + 1]) / (2.0 * STEPS[i]) for i in range(0, len(STEPS), 2)
    )
    return (4.0 * narrow - wide) / 3.0


def optimize_all() -> tuple[np.ndarray, list[Figure]]:
    """Return the best values of all numbers for the cost of transport, and how good they are."""
    problem = Optimization(
        scenario=PRESCRIBED,
        bounds=BOUNDS,
        objectives="cost_of_transport",
        beyond_actuators=True,
        least_velocity=0.5 * swum_speed(PRESCRIBED),
    )
    front = optimize(problem, budget=BUDGET, method="slopes", seed=1, threads=1)
    (best,) = front.values
    again = lc.swim(change_parameters(PRESCRIBED, dict(zip(NAMES, best, strict=True))))
    cost = front.figures["cost_of_transport"][0]
    figures = [
        Figure("cost of transport at the start", float(lc.swim(PRESCRIBED).cost_of_transport)),
        Figure("cost of transport of the best", float(cost)),
        Figure("its error against swim", abs(again.cost_of_transport / cost - 1.0)),
        Figure("points tried", front.n_trials),
    ]
    return best, figures


def identify_from_truth(
    names: Sequence[str], joints: str, series: Mapping[str, float], gaits: Sequence[lc.Gait] = ()
) -> Fit:
    """Fit names to simulated trials that have the changed numbers.

    Args:
        names: Names that are unknown.
        joints: Law of the joints.
        series: What is measured, with the standard deviation of its noise.
        gaits: Gaits of further trials.
    """
    stated = make_scenario(joints)
    unknowns = [make_unknown(name) for name in names]
    measurements: list[Any] = []
    for i, wave in enumerate((GAIT, *gaits)):
        numbers = {"amplitude": wave.amplitude, "frequency": wave.frequency}
        scenario = replace(stated, motion=replace(stated.gait, **numbers))
        truth = change_parameters(scenario, {name: CHANGED[name] for name in names})
        seen = from_trial(lc.swim(truth), name=f"trial {i}", series=series, free_start=False)
        measurements.append(replace(seen, scenario=scenario))
    return fit(
        measurements, parameters=unknowns, joints=joints, n_starts=1, rivals=False, threads=1
    )


def make_unknown(name: str) -> Unknown:
    """Return a name as an unknown that is searched from the value that the robot has."""
    low, high = BOUNDS[name]
    return Unknown(name=name, lower=low, upper=high)


def identify_alone(name: str) -> float:
    """Return the relative error of a value that is identified from a path and joint angles."""
    seen = {"center_of_mass": 0.004, "heading": 0.02, "joint_angle": 0.01}
    found = identify_from_truth([name], "pd", seen)
    return abs(found[name].value - CHANGED[name]) / size_of(name)


def name_unseen(name: str) -> str:
    """Return whether a fit says that a path with prescribed joints does not depend on a number."""
    found = identify_from_truth([name], "prescribed", {"center_of_mass": 0.004, "heading": 0.02})
    return "yes" if NO_EFFECT in found[name].note else "no"


def identify_together() -> Figure:
    """Return the largest error of some numbers that are identified together."""
    seen = {"center_of_mass": 0.004, "heading": 0.02, "joint_angle": 0.01}
    faster = replace(GAIT, amplitude=0.4, frequency=8.0)
    found = identify_from_truth(TOGETHER_IDENTIFIED, "pd", seen, [faster])
    errors = [
        abs(found[name].value - CHANGED[name]) / size_of(name) for name in TOGETHER_IDENTIFIED
    ]
    return Figure("largest error of eight identified together", max(errors))


def is_read_back(name: str, folder: Path) -> str:
    """Return whether a scenario with a changed number, and its robot, are the same after writing and reading."""
    changed = change_parameters(SCENARIO, {name: CHANGED[name]})
    scenario_file = folder / "scenario.toml"
    save_scenario(changed, scenario_file)
    robot_file = folder / "robot.toml"
    robot_file.write_text(to_toml(changed.robot))
    is_same = load_scenario(scenario_file) == changed and lc.load_robot(robot_file) == changed.robot
    return "yes" if is_same else "no"


# ---- flags -----------------------------------------------------------------------------------------


def run_flags(arguments: str) -> None:
    """Run a command as it is typed.

    Args:
        arguments: What is typed after `laticauda`.

    Raises:
        RuntimeError: If it fails.
    """
    status = run_program(shlex.split(arguments))
    if status:
        raise RuntimeError(f"laticauda {arguments} ended with {status}")


def base_flags(folder: Path, joints: str) -> str:
    """Return the flags that select the scenario, apart from amplitudes and leads of single joints.

    Args:
        folder: Folder of the robot's file, which is written.
        joints: Law of the joints.
    """
    robot_file = folder / "robot.toml"
    robot_file.write_text(to_toml(SCENARIO.robot))
    degrees = {name: math.degrees(getattr(GAIT, name)) for name in ANGLES}
    return (
        f"--robot {robot_file} --gait eel-like --amplitude-deg {degrees['amplitude']!r} "
        f"--frequency-deg-s {degrees['frequency']!r} --phase-shift-deg {degrees['phase_shift']!r} "
        f"--offset-deg {degrees['offset']!r} --water {SCENARIO.environment.name} --normal-drag 1.75 "
        f"--duration {DURATION} --dt {DT} --ramp {RAMP} --joints {joints}"
    )


def typed_value(name: str, value: float) -> str:
    """Return a value in the unit that people type."""
    return repr(float(display_unit(PARAMETERS[name].unit).from_si(value)))


def sweep_by_flags(folder: Path) -> np.ndarray:
    """Return the speeds of the same points, run by `laticauda sweep` from a list [m/s]."""
    columns = one_changed_each()
    file = folder / "points.csv"
    with file.open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow([spell_parameter(PARAMETERS[name]) for name in NAMES])
        for i in range(len(NAMES)):
            writer.writerow([typed_value(name, columns[name][i]) for name in NAMES])
    output = folder / "by-flags"
    run_flags(f"sweep {base_flags(folder, 'pd')} --list {file} --output {output} --json")
    return open_sweep(output).forward_velocity.to_numpy()


def optimize_by_flags(folder: Path) -> dict[str, str]:
    """Return for every name whether `laticauda optimize` has its range."""
    ranges: list[str] = []
    for name in NAMES:
        low, high = (typed_value(name, end) for end in BOUNDS[name])
        ranges.append(f"{spell_parameter(PARAMETERS[name])}={low}:{high}")
    output = folder / "optimized"
    run_flags(
        f"optimize {base_flags(folder, 'prescribed')} --vary {' '.join(map(shlex.quote, ranges))} --objective "
        f"cost-of-transport --beyond-actuators --budget 100 --output {output} --json"
    )
    with (output / "front.csv").open(newline="") as stream:
        (best,) = csv.DictReader(stream)
    found: dict[str, str] = {}
    for name in NAMES:
        low, high = BOUNDS[name]
        columns = [column for column in best if column.split(" ")[0] == name]
        is_in_range = columns and low - 1e-9 <= float(best[columns[0]]) <= high + 1e-9
        found[name] = "yes" if is_in_range else "no"
    return found


def identify_by_flags(folder: Path) -> dict[str, str]:
    """Return for every name whether `laticauda identify` finds and writes it: all at once, each with a prior."""
    trial_file = folder / "run.nc"
    # A fit swims with the usual smooth start and time step, whatever those of a trial were.
    usual = replace(SCENARIO, model=lc.Planar(joints=SCENARIO.model.joints), duration=4.0)
    lc.swim(usual).save(trial_file)
    priors = [
        f"{name}={VALUES[name]!r}+-{0.01 * size_of(name)!r}"
        for name in NAMES
        if not is_of_whole_gait(name)
    ]
    output = folder / "identified"
    run_flags(
        f"identify {trial_file} --joints pd --parameters {' '.join(map(shlex.quote, priors))} --measured "
        f"center_of_mass=0.004 joint_angle=0.01 --starts 1 --quick --output {output} --json"
    )
    results = json.loads((output / "fit.json").read_text())
    written = load_scenario(output / "scenario.toml")
    best = {row["name"]: row["best"] for row in results["parameters"]}
    answers: dict[str, str] = {}
    for name in NAMES:
        if is_of_whole_gait(name):
            answers[name] = "commanded"
            continue
        is_written = math.isclose(value_of(name, written), best[name], rel_tol=1e-12)
        is_true = abs(best[name] - VALUES[name]) < 1e-3 * size_of(name)
        answers[name] = "yes" if is_written and is_true else "no"
    return answers


def is_of_whole_gait(name: str) -> bool:
    """Return whether a number is of the commanded wave, which is no unknown."""
    return name.startswith("gait.") and "[" not in name


# ---- exported --------------------------------------------------------------------------------------


def export_all(folder: Path) -> dict[str, tuple[str, float]]:
    """Return for every name whether an FMU has it, and the error of a run with it against `swim`.

    Args:
        folder: Folder of the FMU.
    """
    import fmpy

    file = folder / "robot.fmu"
    export_fmu(file, SCENARIO)
    description = fmpy.read_model_description(str(file))
    settable = {
        variable.name
        for variable in description.modelVariables
        if variable.causality in ("parameter", "input")
    }
    unpacked = fmpy.extract(str(file))
    answers: dict[str, tuple[str, float]] = {}
    for name in NAMES:
        variables = variables_of(name)
        if variables.keys() <= settable:
            error = compare_with_fmu(unpacked, name, variables)
            answers[name] = (describe_variables(name, variables), error)
        else:
            answers[name] = ("no", -1.0)
    return answers


def describe_variables(name: str, variables: Mapping[str, float]) -> str:
    """Return whether an FMU has a variable of a name, or what stands for it."""
    if name in variables:
        return "yes"
    if len(variables) == 1:
        return f"as {next(iter(variables))}"
    return f"part by part, {len(variables)}"


def variables_of(name: str) -> dict[str, float]:
    """Return the variables of an FMU that have the meaning of a changed number, with their values.

    An FMU has a variable for every part, none for ranges and tapers; the amplitude of a joint is
    a share of the gait's amplitude there, which is an input.

    Args:
        name: Name of the number.
    """
    changed = change_parameters(SCENARIO, {name: CHANGED[name]})
    if name.startswith("gait.amplitude["):
        share = CHANGED[name] / GAIT.amplitude
        return {name.replace("amplitude", "envelope"): share}
    if ":" not in name and ".taper." not in name:
        return {name: CHANGED[name]}
    variables: dict[str, float] = {}
    for part in list_names_of_parts(name):
        value = value_of(part, changed)
        if value != value_of(part, SCENARIO):
            variables[part] = value
    return variables


def list_names_of_parts(name: str) -> list[str]:
    """Return the names of a range's or a taper's number in every single part of the robot."""
    if ".taper." in name:
        quantity = name.removeprefix("robot.taper.").rpartition(".")[0]
        return [f"robot.module[{i}].{quantity}" for i in range(N_MODULES)]
    before, _, after = name.partition("[")
    end = after.partition("]")[2]
    n_parts = N_MODULES if before == "robot.module" else N_MODULES - 1
    return [f"{before}[{i}]{end}" for i in range(n_parts)]


def compare_with_fmu(unpacked: str, name: str, variables: Mapping[str, float]) -> float:
    """Return by how much a run of an FMU with a changed number differs from `swim` in where the robot ends [-].

    Args:
        unpacked: Folder of the FMU.
        name: Name of the number.
        variables: Variables that are set instead, with their values.
    """
    import fmpy

    outputs = ["center_of_mass.x", "center_of_mass.y"]
    run = fmpy.simulate_fmu(
        unpacked,
        stop_time=DURATION,
        step_size=0.05,
        output_interval=0.05,
        start_values=variables,
        output=outputs,
    )
    trial = lc.swim(change_parameters(SCENARIO, {name: CHANGED[name]}))
    end = np.array([run[output][-1] for output in outputs])
    swum = trial.center_of_mass[-1, :2]
    path = np.linalg.norm(swum - trial.center_of_mass[0, :2])
    return float(np.linalg.norm(end - swum) / path)


# ---- the table -------------------------------------------------------------------------------------


def run_all(folder: Path) -> tuple[list[Row], list[Figure]]:
    """Return what every name did at every door, and figures of all together.

    Args:
        folder: Folder for files.
    """
    base_speed = swum_speed(SCENARIO)
    alone = np.array(
        [swum_speed(change_parameters(SCENARIO, {name: CHANGED[name]})) for name in NAMES]
    )
    swept = tell("sweep", sweep_all, folder)
    speed_slopes, speed_errors = tell("slopes", compare_slopes, SCENARIO, "forward_velocity")
    power_slopes, power_errors = tell("power", compare_slopes, PRESCRIBED, "net_power")
    best, figures = tell("optimize", optimize_all)
    figures.append(tell("identify together", identify_together))
    by_flags = tell("sweep by flags", sweep_by_flags, folder)
    optimized_by_flags = tell("optimize by flags", optimize_by_flags, folder)
    identified_by_flags = tell("identify by flags", identify_by_flags, folder)
    exported = tell("export", export_all, folder)
    rows: list[Row] = []
    for i, name in enumerate(NAMES):
        recovered_error = -1.0
        unseen = "commanded"
        if not is_of_whole_gait(name):
            recovered_error = tell(name, identify_alone, name)
            unseen = name_unseen(name)
        row = Row(
            name=name,
            unit=PARAMETERS[name].unit,
            value=VALUES[name],
            changed=CHANGED[name],
            speed_change=alone[i] / base_speed - 1.0,
            sweep_error=abs(swept[i] / alone[i] - 1.0),
            speed_slope=speed_slopes[i],
            speed_slope_error=speed_errors[i],
            power_slope=power_slopes[i],
            power_slope_error=power_errors[i],
            optimized=best[i],
            recovered_error=recovered_error,
            unseen=unseen,
            filed=is_read_back(name, folder),
            sweep_flag=spell_parameter(PARAMETERS[name]),
            sweep_flag_error=abs(by_flags[i] / alone[i] - 1.0),
            optimize_flag=optimized_by_flags[name],
            identify_flag=identified_by_flags[name],
            exported=exported[name][0],
            export_error=exported[name][1],
        )
        rows.append(row)
    return rows, figures


def tell(what: str, function: Callable[..., Any], *arguments: Any) -> Any:
    """Return what a function returns, and say that it begins."""
    print(what, file=sys.stderr, flush=True)
    return function(*arguments)


def write_rows(path: Path, rows: Sequence[Any]) -> None:
    """Write rows of a dataclass to a CSV file."""
    with path.open("w", newline="") as stream:
        writer = csv.DictWriter(
            stream, [field.name for field in fields(rows[0])], lineterminator="\n"
        )
        writer.writeheader()
        writer.writerows(map(asdict, rows))


def describe(rows: Sequence[Row], figures: Sequence[Figure]) -> str:
    """Return what the stored tables say, in sentences."""
    exported = [row for row in rows if row.exported != "no"]
    identified = [row for row in rows if row.recovered_error >= 0.0]
    by_parts = [row for row in rows if row.exported.startswith("part by part")]
    lines = [
        f"{len(rows)} names of one body and its gait",
        f"swept: the speed is that of a single swim to {max(row.sweep_error for row in rows):.1e}, "
        f"by flags to {max(row.sweep_flag_error for row in rows):.1e}",
        f"slopes: of the speed as differences to {max(row.speed_slope_error for row in rows):.1e}, "
        f"of the net power to {max(row.power_slope_error for row in rows):.1e}",
        f"identified alone: {len(identified)} to {max(row.recovered_error for row in identified):.1e}; "
        f"{sum(row.unseen == 'yes' for row in rows)} said to have no effect on a path with prescribed joints; "
        f"{len(rows) - len(identified)} refused: the gait was commanded",
        f"read back from files: {sum(row.filed == 'yes' for row in rows)}",
        f"flags of optimize: {sum(row.optimize_flag == 'yes' for row in rows)}, "
        f"of identify: {sum(row.identify_flag == 'yes' for row in rows)}",
        f"exported: {len(exported)}, {len(by_parts)} of them part by part, as swim to "
        f"{max(row.export_error for row in exported):.1e}; not: "
        f"{', '.join(row.name for row in rows if row.exported == 'no') or 'none'}",
        *(f"{figure.what}: {figure.value:.4g}" for figure in figures),
    ]
    return "\n".join(lines)


def main() -> None:
    """Print the stored tables in words; write them anew if asked to."""
    parser = argparse.ArgumentParser(description="Every name of a body and gait")
    parser.add_argument("--write", action="store_true", help="run everything anew")
    if parser.parse_args().write:
        with (
            tempfile.TemporaryDirectory() as folder,
            warnings.catch_warnings(),
            redirect_stdout(sys.stderr),
        ):
            warnings.simplefilter("ignore", InfeasibleWarning)
            rows, figures = run_all(Path(folder))
        write_rows(TABLE, rows)
        write_rows(TOGETHER, figures)
    print(describe(stored(TABLE, Row), stored(TOGETHER, Figure)))


if __name__ == "__main__":
    main()
