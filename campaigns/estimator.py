"""How well is the robot known when motion capture is noisy, loses frames and drops out?

Question: path following of Mamba with servo joints, turning included; markers on the last module
with 1 mm and 0.1 deg of noise, joint sensors with 0.2 deg of noise and 0.5 deg of play, 10 % of the
frames lost, 0.5 % of them reflections some 0.3 m off, frames 10 ms late, and about once in 10 s
nothing for 1 s. How far from the truth are the center of mass and the heading, with the filter and
with kinematics alone (which stands still in a drop-out)?

    python campaigns/estimator.py             # 6 runs of 60 s, 3 seeds each

Noise is drawn by seed. `twin` is the filter beside a plant that is exactly the truth's, which no
real robot will offer; so there are twins in water whose coefficients are all 30 % too high or too
low, and one with C_f and C_A 30 % too high, C_D 30 % too low and 0.6 of the servos' gain. `no twin`
is the filter that knows no water. All are told the play, as a calibration finds it, but
`play not told`. The play is the virtual tank's: the sensor leads by half of it wherever the motor
pulls. Errors are root mean squares after the first 3 s, of the distance in the plane [mm] and of
the heading [deg]. The tests run a slice.

Last answer (2 cores shared with other work, 2026-11-21; then the processor time per tick of 10 ms,
all its samples and the estimate included, and the mean squared errors of place and heading in units
of the filter's own variances):
                                   always      outside in drop-outs   [mm, deg]
    lateral undulation
        twin                   1.45  0.24   1.12  0.12   3.33  0.71  1.18 ms, 0.4 0.3
        twin, water + 30 %     2.29  0.42   1.25  0.15   6.58  1.35  1.42 ms, 0.5 0.4
        twin, water - 30 %     1.77  0.35   1.14  0.12   4.72  1.12  1.20 ms, 0.4 0.4
        twin, mixed, servo     1.79  0.35   1.15  0.13   4.77  1.09  1.20 ms, 0.4 0.4
        twin, play not told    7.32  0.89   7.20  0.85   8.50  1.20  1.13 ms, 17.5 18.6
        no twin                3.86  1.13   1.93  0.24  11.45  3.73  0.71 ms, 0.5 0.3
        kinematics            16.96  3.28   8.30  1.18  50.62 10.39
    lateral undulation, fin
        twin                   1.37  0.13   1.04  0.11   3.19  0.25  1.18 ms, 0.4 0.3
        twin, water + 30 %     2.42  0.16   1.19  0.12   7.20  0.39  1.44 ms, 0.5 0.3
        twin, water - 30 %     2.54  0.19   1.21  0.12   7.63  0.49  1.22 ms, 0.5 0.4
        twin, mixed, servo     2.16  0.20   1.15  0.12   6.27  0.54  1.15 ms, 0.5 0.3
        twin, play not told    6.53  0.64   6.38  0.64   7.93  0.57  1.09 ms, 14.1 10.3
        no twin                4.35  0.27   1.55  0.15  13.79  0.77  0.71 ms, 0.4 0.2
        kinematics            14.85  1.10   7.67  0.76  43.63  2.79
    eel-like
        twin                   1.64  0.22   1.35  0.13   3.35  0.59  0.96 ms, 0.5 0.4
        twin, water + 30 %     2.56  0.28   1.43  0.14   7.28  0.82  0.98 ms, 0.6 0.5
        twin, water - 30 %     2.06  0.33   1.38  0.14   5.25  1.03  0.89 ms, 0.5 0.5
        twin, mixed, servo     2.00  0.37   1.38  0.14   4.98  1.13  0.92 ms, 0.5 0.5
        twin, play not told    8.89  0.96   8.87  0.96   9.20  1.03  1.11 ms, 20.9 24.4
        no twin                3.81  0.90   1.85  0.23  11.19  2.87  0.72 ms, 0.5 0.3
        kinematics            14.93  3.73   9.78  1.31  38.13 11.62
    eel-like, fin
        twin                   1.59  0.21   1.18  0.11   3.68  0.58  0.96 ms, 0.4 0.3
        twin, water + 30 %     2.48  0.30   1.26  0.12   7.10  0.89  0.97 ms, 0.4 0.4
        twin, water - 30 %     2.76  0.24   1.31  0.12   8.06  0.68  0.90 ms, 0.5 0.4
        twin, mixed, servo     2.93  0.31   1.36  0.13   8.65  0.94  0.94 ms, 0.5 0.4
        twin, play not told    9.63  0.89   9.33  0.87  12.08  1.13  1.07 ms, 22.7 21.7
        no twin                3.62  0.44   1.70  0.17  10.61  1.35  0.71 ms, 0.4 0.2
        kinematics            15.55  1.28  10.50  0.93  38.66  3.02
    straight, fast
        twin                   1.32  0.12   1.13  0.11   2.59  0.23  1.20 ms, 0.4 0.3
        twin, water + 30 %     2.09  0.13   1.33  0.11   5.59  0.26  1.41 ms, 0.6 0.3
        twin, water - 30 %     1.63  0.14   1.21  0.11   3.90  0.28  1.07 ms, 0.5 0.3
        twin, mixed, servo     1.43  0.13   1.12  0.11   3.25  0.26  1.11 ms, 0.4 0.3
        twin, play not told    7.33  0.79   7.30  0.80   7.67  0.72  0.96 ms, 16.4 16.0
        no twin                1.96  0.18   1.46  0.14   4.63  0.40  0.77 ms, 0.4 0.2
        kinematics            24.29  2.85   9.04  1.13  76.67  8.92
    straight, fast, fin
        twin                   1.25  0.13   1.11  0.12   2.22  0.25  1.19 ms, 0.4 0.3
        twin, water + 30 %     1.85  0.14   1.26  0.12   4.73  0.28  1.43 ms, 0.5 0.3
        twin, water - 30 %     1.74  0.14   1.21  0.11   4.41  0.27  1.07 ms, 0.5 0.3
        twin, mixed, servo     1.31  0.13   1.12  0.12   2.58  0.24  1.12 ms, 0.4 0.3
        twin, play not told    5.00  0.44   4.94  0.44   5.64  0.48  1.01 ms, 7.7 4.7
        no twin                2.28  0.18   1.53  0.16   5.92  0.33  0.76 ms, 0.4 0.2
        kinematics            19.94  1.10   7.06  0.64  63.37  3.08
"""

import argparse
import math
import time
from collections import deque
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

import laticauda as lc
from laticauda.control.estimation import (
    Estimate,
    Estimator,
    JointSample,
    KinematicEstimator,
    PoseSample,
    ReferenceSample,
    Sample,
)
from laticauda.robot import load_water
from laticauda.robot.kinematics import Posture

INTERVAL = 0.01
"""Time between two samples of everything [s]."""
SETTLED = 3.0
"""Time from which errors count [s]."""
BACKLASH = math.radians(0.5)
"""Play of the joints [rad]."""


@dataclass(frozen=True, kw_only=True)
class Sensors:
    """How bad the sensors are."""

    position: float = 0.001
    """Noise of the marker body's position [m]."""
    yaw: float = math.radians(0.1)
    """Noise of its yaw [rad]."""
    joint: float = math.radians(0.2)
    """Noise of joint angles [rad]."""
    backlash: float = BACKLASH
    torque: float = 0.1
    """Noise of joint torques [N m]."""
    lost: float = 0.1
    """Share of frames that are lost."""
    outliers: float = 0.005
    """Share of frames that are reflections."""
    latency: float = 0.01
    """Delay of frames [s]."""
    drop_out: float = 1.0
    """Duration of a drop-out [s]."""
    between: float = 10.0
    """Time from one drop-out to the next, about; inf: none [s]."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """One run through the water."""

    name: str
    robot: str
    gait: str = "lateral_undulation"
    amplitude_deg: float = 30.0
    frequency_deg_s: float = 90.0
    is_following: bool = True


CASES = (
    Case(name="lateral undulation", robot="mamba"),
    Case(name="lateral undulation, fin", robot="mamba-fin"),
    Case(name="eel-like", robot="mamba-modules", gait="eel_like", amplitude_deg=40.0),
    Case(name="eel-like, fin", robot="mamba-modules-fin", gait="eel_like", amplitude_deg=40.0),
    Case(name="straight, fast", robot="mamba", frequency_deg_s=130.0, is_following=False),
    Case(name="straight, fast, fin", robot="mamba-fin", frequency_deg_s=130.0, is_following=False),
)


def water_of(case: Case) -> lc.Water:
    """The water that was identified with the gait."""
    return load_water("paper-eel" if case.gait == "eel_like" else "paper-lateral")


def truth(case: Case, duration: float) -> lc.Trial:
    """What really happened."""
    make = lc.lateral_undulation if case.gait == "lateral_undulation" else lc.eel_like
    gait = make(
        amplitude=math.radians(case.amplitude_deg),
        frequency=math.radians(case.frequency_deg_s),
        phase_shift=math.radians(40.0),
    )
    plant = lc.build_plant(lc.load_robot(case.robot), water_of(case), joints="servo")
    controller: Any = lc.OpenLoop(command=lc.Command(gait=gait))
    if case.is_following:
        controller = lc.PathFollowing(
            gait=gait,
            path=lc.StraightLine(),
            guidance=lc.LineOfSight(look_ahead_distance=0.18),
            heading=lc.HeadingController(gain=0.4, max_offset=math.radians(20.0)),
        )
    start = lc.Start(center_of_mass=(0.0, 1.2), heading=math.radians(8.0))
    return lc.run(plant, controller, duration, start=start, sample_interval=INTERVAL)


class Arrival(NamedTuple):
    """A sample that arrives."""

    time: float
    """When [s]."""
    sample: Sample

    @property
    def rank(self) -> tuple[float, int]:
        """By which arrivals are sorted: of those at the same time, references come first and poses last."""
        kinds = (ReferenceSample, JointSample, PoseSample)
        return self.time, kinds.index(type(self.sample))


class Sensed(NamedTuple):
    """What the sensors make of a trial."""

    arrivals: list[Arrival]
    """In the order of their arrival."""
    is_dropped: np.ndarray
    """Whether there are no frames at all, by the trial's times."""


def sense(trial: lc.Trial, sensors: Sensors, seed: int) -> Sensed:
    """What the sensors make of a trial."""
    chance = np.random.default_rng(seed)
    n = trial.time.size
    chain = trial.robot.planar()
    marker = Posture(chain, trial.center_of_mass, trial.link_angle).link_centers[:, 0]
    marker = marker + chance.normal(0.0, sensors.position, marker.shape)
    yaw = trial.link_angle[:, 0] + chance.normal(0.0, sensors.yaw, n)
    leads = 0.5 * sensors.backlash * np.tanh(trial.joint_torque / 0.2)
    joint = trial.joint_angle + leads + chance.normal(0.0, sensors.joint, trial.joint_angle.shape)
    torque = trial.joint_torque + chance.normal(0.0, sensors.torque, joint.shape)
    is_dropped = draw_drop_outs(trial.time, sensors, chance)
    is_lost = is_dropped | (chance.random(n) < sensors.lost)
    is_outlier = chance.random(n) < sensors.outliers
    marker[is_outlier] += chance.normal(0.0, 0.3, (int(is_outlier.sum()), 2))
    assert trial.gait is not None
    arrivals: list[Arrival] = []
    for k, now in enumerate(trial.time.tolist()):
        reference = ReferenceSample(
            time=now, angle=trial.joint_angle_ref[k], frequency=trial.gait.frequency
        )
        arrivals.append(Arrival(now, reference))
        measured = JointSample(time=now, angle=joint[k], torque=torque[k])
        arrivals.append(Arrival(now, measured))
        if not is_lost[k]:
            position = np.array([marker[k, 0], marker[k, 1], -0.15])
            pose = PoseSample(time=now, position=position, rotation=_rotation_of(yaw[k]))
            arrivals.append(Arrival(now + sensors.latency, pose))
    arrivals.sort(key=lambda arrival: arrival.rank)
    return Sensed(arrivals, is_dropped)


def draw_drop_outs(times: np.ndarray, sensors: Sensors, chance: np.random.Generator) -> np.ndarray:
    """Which times have no frames at all."""
    is_dropped = np.zeros(times.size, dtype=bool)
    begin = SETTLED + chance.uniform(0.5, 1.0) * sensors.between
    while math.isfinite(begin) and begin + sensors.drop_out < times[-1]:
        is_dropped |= (times >= begin) & (times < begin + sensors.drop_out)
        begin += chance.uniform(0.6, 1.4) * sensors.between
    return is_dropped


class Estimated(NamedTuple):
    """What an estimator makes of samples."""

    estimates: list[Estimate | None]
    """At the ticks of a loop."""
    cost: float
    """Processor time per tick [s]."""


def estimate(estimator: Any, arrivals: Sequence[Arrival], times: np.ndarray) -> Estimated:
    """Let an estimator take samples as they arrive, and estimate at every tick."""
    state = estimator.init()
    estimates: list[Estimate | None] = []
    waiting = deque(arrivals)
    begin = time.thread_time()
    for now in times.tolist():
        while waiting and waiting[0].time <= now + 1e-9:
            state = estimator.step(state, waiting.popleft().sample)
        estimates.append(estimator.estimate(state, now))
    return Estimated(estimates, (time.thread_time() - begin) / times.size)


@dataclass(frozen=True, kw_only=True)
class Errors:
    """Root mean squares of distance [mm] and heading [deg]: always, outside of drop-outs, in them."""

    always: np.ndarray
    outside: np.ndarray
    inside: np.ndarray


def errors(trial: lc.Trial, estimates: Sequence[Estimate | None], is_dropped: np.ndarray) -> Errors:
    """How far the estimates are from the truth."""
    is_known = np.array([known is not None for known in estimates]) & (trial.time >= SETTLED)
    errors_of_times = np.zeros((trial.time.size, 2))
    for k in np.flatnonzero(is_known):
        known = estimates[k]
        assert known is not None
        distance = np.linalg.norm(known.center_of_mass - trial.center_of_mass[k])
        errors_of_times[k] = 1e3 * distance, math.degrees(known.heading - trial.heading[k])

    def of(chosen: np.ndarray) -> np.ndarray:
        if not chosen.any():
            return np.zeros(2)
        return _root_mean_square(errors_of_times[chosen])

    return Errors(
        always=of(is_known),
        outside=of(is_known & ~is_dropped),
        inside=of(is_known & is_dropped),
    )


def _root_mean_square(values: np.ndarray) -> np.ndarray:
    """Of every column."""
    return np.sqrt((values**2).mean(axis=0))


class Consistency(NamedTuple):
    """Mean squared errors in units of the stated variance: 1 if the filter knows its errors."""

    place: float
    heading: float


def consistency(trial: lc.Trial, estimates: Sequence[Estimate | None]) -> Consistency:
    """How well the filter knows its errors."""
    place: list[float] = []
    heading: list[float] = []
    for k, known in enumerate(estimates):
        if known is None or trial.time[k] < SETTLED:
            continue
        place_error = (known.center_of_mass - trial.center_of_mass[k]) / known.center_of_mass_std
        heading_error = (known.heading - trial.heading[k]) / known.heading_std
        place.append(0.5 * float(place_error @ place_error))
        heading.append(heading_error**2)
    return Consistency(float(np.mean(place)), float(np.mean(heading)))


def _rotation_of(yaw: float) -> np.ndarray:
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _mean(errors_of_seeds: Sequence[Errors]) -> Errors:
    """Of several seeds, as a root mean square."""
    return Errors(
        always=_root_mean_square(np.array([seed.always for seed in errors_of_seeds])),
        outside=_root_mean_square(np.array([seed.outside for seed in errors_of_seeds])),
        inside=_root_mean_square(np.array([seed.inside for seed in errors_of_seeds])),
    )


def _describe(mean: Errors) -> str:
    cells: list[str] = []
    for millimeters, degrees in (mean.always, mean.outside, mean.inside):
        cells.append(f"{millimeters:6.2f} {degrees:5.2f}")
    return " ".join(cells)


@dataclass(frozen=True, kw_only=True)
class Twin:
    """A digital twin, and how wrong it is: factors."""

    friction: float = 1.0
    """Of C_f."""
    drag: float = 1.0
    """Of C_D."""
    added: float = 1.0
    """Of C_A and C_M."""
    servo_gain: float = 1.0

    def plant(self, case: Case) -> Any:
        """The plant that runs beside the filter."""
        water = water_of(case)
        robot = lc.load_robot(case.robot)
        wrong_water = replace(
            water,
            tangential_friction=self.friction * water.tangential_friction,
            normal_drag=self.drag * water.normal_drag,
            added_mass=self.added * water.added_mass,
            added_inertia=self.added * water.added_inertia,
        )
        joints: list[Any] = []
        for joint in robot.joints:
            servo_gain = self.servo_gain * joint.actuator.servo_gain
            actuator = replace(joint.actuator, servo_gain=servo_gain)
            joints.append(replace(joint, actuator=actuator))
        wrong_robot = replace(robot, joints=tuple(joints))
        return lc.build_plant(wrong_robot, wrong_water, joints="servo")


TWINS = {
    "twin": Twin(),
    "twin, water + 30 %": Twin(friction=1.3, drag=1.3, added=1.3),
    "twin, water - 30 %": Twin(friction=0.7, drag=0.7, added=0.7),
    "twin, mixed, servo": Twin(friction=1.3, drag=0.7, added=1.3, servo_gain=0.6),
}


def table(case: Case, n_seeds: int, duration: float) -> list[str]:
    """The lines of one run."""
    trial = truth(case, duration)
    estimators: dict[str, Any] = {
        name: Estimator(robot=trial.robot, backlash=BACKLASH, plant=twin.plant(case))
        for name, twin in TWINS.items()
    }
    estimators |= {
        "twin, play not told": Estimator(robot=trial.robot, plant=TWINS["twin"].plant(case)),
        "no twin": Estimator(robot=trial.robot, backlash=BACKLASH),
        "kinematics": KinematicEstimator(robot=trial.robot),
    }
    lines = [case.name]
    for name, estimator in estimators.items():
        is_filter = name != "kinematics"
        sensors = Sensors()
        if not is_filter:  # it has no defense against reflections, and is spared them
            sensors = Sensors(outliers=0.0)
        errors_of_seeds: list[Errors] = []
        costs: list[float] = []
        consistencies: list[Consistency] = []
        for seed in range(n_seeds):
            sensed = sense(trial, sensors, seed)
            estimated = estimate(estimator, sensed.arrivals, trial.time)
            errors_of_seeds.append(errors(trial, estimated.estimates, sensed.is_dropped))
            costs.append(estimated.cost)
            if is_filter:
                consistencies.append(consistency(trial, estimated.estimates))
        line = f"    {name:20} {_describe(_mean(errors_of_seeds))}"
        if is_filter:
            place, heading = np.mean(consistencies, axis=0)
            line += f"  {1e3 * min(costs):.2f} ms, {place:.1f} {heading:.1f}"
        lines.append(line)
    return lines


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--duration", type=float, default=60.0)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    print(f"{'':24} {'always':>12} {'outside':>12} {'in drop-outs':>12}   [mm, deg]", flush=True)
    with ProcessPoolExecutor(options.jobs) as pool:
        ask = partial(table, n_seeds=options.seeds, duration=options.duration)
        for lines in pool.map(ask, CASES):
            print("\n".join(lines), flush=True)


if __name__ == "__main__":
    main()
