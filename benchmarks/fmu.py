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
DURATION = 30.0  # s


def begun(folder: str) -> tuple[Any, dict[str, int]]:
    """An instance that is ready for its first step, and the value references by name."""
    from fmpy import read_model_description
    from fmpy.fmi2 import FMU2Slave

    told = read_model_description(folder)
    identifier = told.coSimulation.modelIdentifier
    one = FMU2Slave(
        guid=told.guid, unzipDirectory=folder, modelIdentifier=identifier, instanceName="snake"
    )
    one.instantiate()
    one.setupExperiment()
    one.enterInitializationMode()
    one.exitInitializationMode()
    return one, {v.name: v.valueReference for v in told.modelVariables}


def alone(folder: str, interval: float) -> float:
    """Time of a core of the FMU's steps, and nothing else [s]."""
    one, _ = begun(folder)
    start = time.process_time()
    for k in range(round(DURATION / interval)):
        one.doStep(k * interval, interval)
    return time.process_time() - start


def speeds(folder: Path) -> None:
    """Print how many seconds of swimming go by per second, and how near the results are."""
    from fmpy import extract, read_model_description, simulate_fmu

    print(
        f"{'joints':<12}{'step [ms]':>10}{'FMPy [s/s]':>12}{'steps':>10}{'swim':>10}{'m':>10}{'rad':>10}{'N m':>10}"
    )
    for joints in ("prescribed", "servo"):
        export_fmu(folder / f"{joints}.fmu", ROBOT, GAIT, joints=joints)
        unpacked = extract(str(folder / f"{joints}.fmu"), str(folder / joints))
        told = read_model_description(unpacked)
        for interval in (0.05, 0.01):

            def in_fmpy(
                unpacked: str = unpacked, told: Any = told, interval: float = interval
            ) -> Any:
                settings = {
                    "stop_time": DURATION,
                    "step_size": interval,
                    "output_interval": interval,
                }
                return simulate_fmu(unpacked, model_description=told, **settings)

            def in_python(joints: str = joints, interval: float = interval) -> lc.Trial:
                return lc.swim(ROBOT, GAIT, DURATION, joints=joints, sample_interval=interval)

            seen, trial = in_fmpy(), in_python()
            gaps = [
                max(
                    float(np.abs(seen[name + part] - column).max())
                    for part, column in zip(parts, of.T, strict=False)
                )
                for name, parts, of in (
                    ("center_of_mass", (".x", ".y"), trial.center_of_mass),
                    ("link_angle", [f"[{i}]" for i in range(9)], trial.link_angle),
                    ("joint_torque", [f"[{i}]" for i in range(8)], trial.joint_torque),
                )
            ]
            times = (
                fastest(time.process_time, in_fmpy, 3),
                min(alone(unpacked, interval) for _ in range(3)),
            )
            rates = [DURATION / t for t in (*times, fastest(time.process_time, in_python, 3))]
            print(
                f"{joints:<12}{1e3 * interval:>10.0f}{rates[0]:>12.0f}{rates[1]:>10.0f}{rates[2]:>10.0f}",
                end="",
            )
            print("".join(f"{gap:>10.0e}" for gap in gaps))


def order(folder: Path) -> None:
    """Print how the error of held references falls with the communication step."""
    from fmpy import extract

    export_fmu(folder / "held.fmu", ROBOT, GAIT, joints="servo", inputs="references")
    unpacked = extract(str(folder / "held.fmu"), str(folder / "held"))
    print(f"\n{'step [ms]':>10}{'error [mm]':>12}{'order':>8}")
    before = math.nan
    for interval in (0.08, 0.04, 0.02, 0.01, 0.005):
        trial = lc.swim(ROBOT, GAIT, 10.0, joints="servo", sample_interval=interval)
        one, number = begun(unpacked)
        joints = [number[f"references[{i}]"] for i in range(ROBOT.n_joints)]
        for k, asked in enumerate(trial.joint_angle_ref[:-1]):
            one.setReal(joints, asked.tolist())
            one.doStep(k * interval, interval)
        there = one.getReal([number["center_of_mass.x"], number["center_of_mass.y"]])
        error = float(np.linalg.norm(np.array(there) - trial.center_of_mass[-1]))
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
