"""How fast is an FMU, how near is it to a swim, and how does it depend on the communication step?

30 s of Mamba with its fin through FMPy (`pip install fmpy`): its own loop, and the FMU's steps
alone, beside `swim` with as many samples; the greatest differences between the two runs. Then 10 s
of servos whose references are sampled from a gait at every communication step: how far the center
of mass is from that of a swim, in which the gait goes on.
"""

import math
import sys
import tempfile
import time
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from _timing import fastest, print_load

import laticauda as lc
from laticauda.connect import export_fmu

GAIT = lc.lateral_undulation(
    amplitude=math.radians(30), frequency=math.radians(130), phase_shift=math.radians(40)
)
ROBOT = lc.load_robot("mamba-fin")
DURATION = 30.0
"""Duration of the swims [s]."""


def start_instance(folder: str) -> tuple[Any, dict[str, int]]:
    """Return an instance that is ready for its first step, and the value references by name."""
    from fmpy import read_model_description
    from fmpy.fmi2 import FMU2Slave

    description = read_model_description(folder)
    instance = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="snake",
    )
    instance.instantiate()
    instance.setupExperiment()
    instance.enterInitializationMode()
    instance.exitInitializationMode()
    references = {v.name: v.valueReference for v in description.modelVariables}
    return instance, references


def time_steps(folder: str, interval: float) -> float:
    """Time of a core of the FMU's steps, and nothing else [s]."""
    instance, _ = start_instance(folder)
    start = time.process_time()
    for k in range(round(DURATION / interval)):
        instance.doStep(k * interval, interval)
    return time.process_time() - start


def largest_difference(outputs: Any, names: list[str], values: np.ndarray) -> float:
    """Largest difference between outputs of an FMU and the columns of a trial's values."""
    differences = [
        float(np.abs(outputs[name] - column).max())
        for name, column in zip(names, values.T, strict=False)
    ]
    return max(differences)


def differences_of(outputs: Any, trial: lc.Trial) -> list[float]:
    """Largest differences between an FMU's run and a trial: [m], [rad], [N m]."""
    positions = ["center_of_mass.x", "center_of_mass.y"]
    angles = [f"link_angle[{i}]" for i in range(9)]
    torques = [f"joint_torque[{i}]" for i in range(8)]
    return [
        largest_difference(outputs, positions, trial.center_of_mass),
        largest_difference(outputs, angles, trial.link_angle),
        largest_difference(outputs, torques, trial.joint_torque),
    ]


def speeds(folder: Path) -> None:
    """Print how many seconds of swimming go by per second, and how near the results are."""
    from fmpy import extract, read_model_description, simulate_fmu

    print(
        f"{'joints':<12}{'step [ms]':>10}{'FMPy [s/s]':>12}{'steps':>10}{'swim':>10}{'m':>10}{'rad':>10}{'N m':>10}"
    )
    for joints in ("prescribed", "servo"):
        export_fmu(folder / f"{joints}.fmu", ROBOT, GAIT, joints=joints)
        unpacked = extract(str(folder / f"{joints}.fmu"), str(folder / joints))
        description = read_model_description(unpacked)
        for interval in (0.05, 0.01):
            in_fmpy = partial(
                simulate_fmu,
                unpacked,
                model_description=description,
                stop_time=DURATION,
                step_size=interval,
                output_interval=interval,
            )
            in_python = partial(
                lc.swim, ROBOT, GAIT, DURATION, joints=joints, sample_interval=interval
            )
            differences = differences_of(in_fmpy(), in_python())
            rate_of_fmpy = DURATION / fastest(time.process_time, in_fmpy, 3)
            rate_of_steps = DURATION / min(time_steps(unpacked, interval) for _ in range(3))
            rate_of_swim = DURATION / fastest(time.process_time, in_python, 3)
            line = f"{joints:<12}{1e3 * interval:>10.0f}"
            line += f"{rate_of_fmpy:>12.0f}{rate_of_steps:>10.0f}{rate_of_swim:>10.0f}"
            print(line + "".join(f"{difference:>10.0e}" for difference in differences))


def order(folder: Path) -> None:
    """Print how the error of held references falls with the communication step."""
    from fmpy import extract

    export_fmu(folder / "held.fmu", ROBOT, GAIT, joints="servo", inputs="references")
    unpacked = extract(str(folder / "held.fmu"), str(folder / "held"))
    print(f"\n{'step [ms]':>10}{'error [mm]':>12}{'order':>8}")
    before = math.nan
    for interval in (0.08, 0.04, 0.02, 0.01, 0.005):
        trial = lc.swim(ROBOT, GAIT, 10.0, joints="servo", sample_interval=interval)
        instance, references = start_instance(unpacked)
        joints = [references[f"references[{i}]"] for i in range(ROBOT.n_joints)]
        for k, angles in enumerate(trial.joint_angle_ref[:-1]):
            instance.setReal(joints, angles.tolist())
            instance.doStep(k * interval, interval)
        end = instance.getReal([references["center_of_mass.x"], references["center_of_mass.y"]])
        error = float(np.linalg.norm(np.array(end) - trial.center_of_mass[-1]))
        print(f"{1e3 * interval:>10.0f}{1e3 * error:>12.2f}{math.log2(before / error):>8.2f}")
        before = error


def main() -> None:
    """Print both tables."""
    try:
        import fmpy  # noqa: F401
    except ImportError:
        print("It needs FMPy: pip install fmpy", file=sys.stderr)
        return
    print_load()
    with tempfile.TemporaryDirectory() as folder:
        speeds(Path(folder))
        order(Path(folder))


if __name__ == "__main__":
    main()
