"""How far are default steps from steps 16 times smaller, for every kind of joint?

Question: are speeds right to 1e-5 and powers to 1e-4? Printed for the nine settings of the paper's
Table 1, without and with the fin, 30 s: the worst relative error of `forward_velocity`,
`mean_power` and of the place at the end (of the distance), at the default step and at half of it.

    python benchmarks/convergence.py [MODEL]    planar (the default) or spatial

The small steps are always those of the planar model.
"""

import sys
import warnings

import numpy as np

import laticauda as lc
from laticauda.motion.gaits import envelope_of

SETTINGS = (
    ("lateral_undulation", 30, 130, 40),
    ("lateral_undulation", 30, 150, 40),
    ("lateral_undulation", 36, 110, 40),
    ("lateral_undulation", 30, 110, 35),
    ("eel_like", 30, 130, 40),
    ("eel_like", 30, 150, 40),
    ("eel_like", 48, 110, 40),
    ("eel_like", 50, 110, 40),
    ("eel_like", 30, 110, 35),
)
JOINTS = ("prescribed", "pd", "servo", "speed-servo", "mamba-identified", "ekeberg", "hill")
FINER = 16


def gaits() -> list[lc.Gait]:
    """The gaits of the settings."""
    gaits_of_settings: list[lc.Gait] = []
    for kind, *degrees in SETTINGS:
        amplitude, frequency, phase_shift = np.deg2rad(degrees)
        gait = lc.Gait(
            envelope=envelope_of(kind),
            amplitude=amplitude,
            frequency=frequency,
            phase_shift=phase_shift,
        )
        gaits_of_settings.append(gait)
    return gaits_of_settings


def errors(swims: lc.Swims, exact: lc.Swims) -> list[float]:
    """Worst relative errors of speed, power and place."""
    distance = np.linalg.norm(swims.center_of_mass[:, :2] - exact.center_of_mass, axis=1)
    return [
        float(np.max(np.abs(swims.forward_velocity / exact.forward_velocity - 1.0))),
        float(np.max(np.abs(swims.mean_power / exact.mean_power - 1.0))),
        float(np.max(distance / np.linalg.norm(exact.center_of_mass, axis=1))),
    ]


def main() -> None:
    """Print the table."""
    model = sys.argv[1] if len(sys.argv) > 1 else "planar"
    warnings.simplefilter("ignore", lc.InfeasibleWarning)
    print(f"{'joints':<18}{'step [s]':>10}{'speed':>10}{'power':>10}{'place':>10}")
    for joints in JOINTS:
        rows: dict[float, list[float]] = {}
        for name in ("mamba", "mamba-fin"):
            robot = lc.load_robot(name)
            water = lc.load_water("paper-lateral")
            law = joints
            if joints == "mamba-identified":
                parameters = lc.load_parameters(joints)
                robot = parameters.robot(robot, "lateral-undulation")
                water = parameters.water("lateral-undulation")
                law = parameters.joints or joints
            case = {"joints": law, "environments": water}
            default_dt = lc.build_plant(robot, water, model=model, joints=law).dt
            exact = lc.swim_many(robot, gaits(), dt=default_dt / FINER, **case)
            for dt in (default_dt, default_dt / 2):
                swims = lc.swim_many(robot, gaits(), model=model, dt=dt, **case)
                errors_at_dt = errors(swims, exact)
                rows[dt] = list(np.maximum(rows.get(dt, [0.0] * 3), errors_at_dt))
        for dt, worst in rows.items():
            numbers = "".join(f"{error:>10.1e}" for error in worst)
            print(f"{joints:<18}{dt:>10.5f}{numbers}")


if __name__ == "__main__":
    main()
