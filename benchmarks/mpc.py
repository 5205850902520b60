"""Model-predictive control against line of sight, with and without an integral, in a current across the path.

Question: Mamba with its fin follows the x axis from 1 m beside it for 180 s, in no current and in
0.03 and 0.06 m/s across. How far from the path is it in the last 60 s, what does a meter along the
path take, and is the plan there in time?

    python benchmarks/mpc.py

Lateral undulation of 30 deg, 90 deg/s, 40 deg; prescribed joints. The averaged model comes from
four trials in still water that are run first. Errors are means over the gait cycle. The time is
that of a whole control instant, filter and solver, on the wall: other work on the machine adds to
it.
"""

import math
import time
from dataclasses import replace
from typing import Any

import numpy as np
from _timing import print_load

import laticauda as lc
from laticauda.control import ModelPredictive, OffsetSteps, fit_averaged
from laticauda.trials import following

CURRENTS = (0.0, 0.03, 0.06)  # across, to the left [m/s]
FREQUENCIES_DEG_S = (60.0, 80.0, 100.0, 120.0)
DURATION, LATE = 180.0, 120.0  # [s]
POWER_LIMIT = 15.0  # W
GAIT = lc.lateral_undulation(
    amplitude=math.radians(30), frequency=math.radians(90), phase_shift=math.radians(40)
)
INSTANTS: list[float] = []


class Timed(ModelPredictive):
    """Notes how long each control instant takes [s]."""

    def step(self, state: Any, observation: lc.Observation) -> Any:
        begin = time.perf_counter()
        after = super().step(state, observation)
        INSTANTS.append(time.perf_counter() - begin)
        return after


def water(current: float) -> lc.Water:
    return replace(lc.load_water("paper-lateral"), current=(0.0, current))


def body(current: float) -> lc.Plant[Any]:
    return lc.build_plant(lc.load_robot("mamba-fin"), water(current), offset_bandwidth=10.0)


def controllers() -> dict[str, Any]:
    still = body(0.0)
    steps = [OffsetSteps(gait=replace(GAIT, frequency=math.radians(f))) for f in FREQUENCIES_DEG_S]
    model = fit_averaged([lc.run(still, each, each.duration) for each in steps])
    print(model)
    line, limit = lc.StraightLine(), math.radians(20.0)
    near = lc.LineOfSight(look_ahead_distance=0.18)
    far = lc.LineOfSight(look_ahead_distance=1.62)
    learns = lc.IntegralLineOfSight(look_ahead_distance=1.62, integral_gain=0.12)

    def sight(law: Any, gain: float) -> lc.PathFollowing:
        heading = lc.HeadingController(gain=gain, max_offset=limit)
        return lc.PathFollowing(gait=GAIT, path=line, guidance=law, heading=heading)

    free = (math.radians(60.0), math.radians(120.0))
    plans = {"gait": GAIT, "path": line, "model": model, "speed": 0.12}
    return {
        "LOS, 0.18 m": sight(near, 0.4),
        "LOS, 1.62 m": sight(far, 0.25),
        "ILOS, 1.62 m": sight(learns, 0.25),
        "MPC, 90 deg/s": Timed(**plans),
        "MPC, 15 W": Timed(**plans, frequency_limits=free, power_limit=POWER_LIMIT),
    }


def row(name: str, current: float, trial: lc.Trial) -> str:
    assert trial.period is not None
    middle, error = following.mean_error(
        trial.time, trial.signals["cross_track_error"], trial.period
    )
    late, end = error[middle >= LATE], trial.time >= LATE
    spent, along = np.ptp(trial.work[end, 0]), np.ptp(trial.signals["along_track_distance"][end])
    seconds = DURATION - LATE
    words = f"| {name} | {current:.2f} | {1e3 * math.sqrt(np.mean(late**2)):.1f} | {1e3 * np.mean(late):.1f} "
    words += f"| {along / seconds:.3f} | {spent / seconds:.1f} | {spent / along:.0f} "
    if not INSTANTS:
        return f"{words}| | |"
    half, most = (1e3 * float(np.percentile(INSTANTS, share)) for share in (50, 99))
    assert trial.signals["is_fallback"].max() == 0.0
    return f"{words}| {half:.1f} | {most:.1f} |"


def main() -> None:
    print_load()
    each = controllers()
    print(
        "| law | current [m/s] | rms error [mm] | mean [mm] | along [m/s] | power [W] | J/m | p50 [ms] | p99 [ms] |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    for name, controller in each.items():
        for current in CURRENTS:
            INSTANTS.clear()
            trial = lc.run(
                body(current), controller, DURATION, start=lc.Start(center_of_mass=(0.0, 1.0))
            )
            print(row(name, current, trial), flush=True)


if __name__ == "__main__":
    main()
