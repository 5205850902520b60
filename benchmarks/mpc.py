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
    line = lc.StraightLine()
    near = lc.LineOfSight(look_ahead_distance=0.18)
    far = lc.LineOfSight(look_ahead_distance=1.62)
    integral = lc.IntegralLineOfSight(look_ahead_distance=1.62, integral_gain=0.12)

    def follow(law: Any, gain: float) -> lc.PathFollowing:
        heading = lc.HeadingController(gain=gain, max_offset=math.radians(20.0))
        return lc.PathFollowing(gait=GAIT, path=line, guidance=law, heading=heading)

    plan = Timed(gait=GAIT, path=line, model=model, speed=0.12)
    limits = (math.radians(60.0), math.radians(120.0))
    return {
        "LOS, 0.18 m": follow(near, 0.4),
        "LOS, 1.62 m": follow(far, 0.25),
        "ILOS, 1.62 m": follow(integral, 0.25),
        "MPC, 90 deg/s": plan,
        "MPC, 15 W": replace(plan, frequency_limits=limits, power_limit=POWER_LIMIT),
    }


def row(name: str, current: float, trial: lc.Trial) -> str:
    assert trial.period is not None
    time, error = following.mean_error(trial.time, trial.signals["cross_track_error"], trial.period)
    late_error = error[time >= LATE]
    rms = math.sqrt(np.mean(late_error**2))
    is_late = trial.time >= LATE
    energy = np.ptp(trial.work[is_late, 0])
    distance = np.ptp(trial.signals["along_track_distance"][is_late])
    duration = DURATION - LATE
    cells = [name, f"{current:.2f}", f"{1e3 * rms:.1f}", f"{1e3 * np.mean(late_error):.1f}"]
    cells += [f"{distance / duration:.3f}", f"{energy / duration:.1f}"]
    cells += [f"{energy / distance:.0f}"]
    if not INSTANTS:
        return f"| {' | '.join(cells)} | | |"
    assert trial.signals["is_fallback"].max() == 0.0
    cells += [f"{1e3 * np.percentile(INSTANTS, share):.1f}" for share in (50, 99)]
    return f"| {' | '.join(cells)} |"


def main() -> None:
    print_load()
    compared = controllers()
    print(
        "| law | current [m/s] | rms error [mm] | mean [mm] | along [m/s] | power [W] | J/m | p50 [ms] | p99 [ms] |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    for name, controller in compared.items():
        for current in CURRENTS:
            INSTANTS.clear()
            trial = lc.run(
                body(current), controller, DURATION, start=lc.Start(center_of_mass=(0.0, 1.0))
            )
            print(row(name, current, trial), flush=True)


if __name__ == "__main__":
    main()
