"""Runs, what the sensors make of them, and recordings, for the tests of this folder."""

import math
from functools import cache
from pathlib import Path
from typing import Any

import campaign_scripts

import laticauda as lc
from laticauda.control.estimation import Estimator
from laticauda.scenarios import Experiment
from laticauda.tank.operate import Decision, Event, Header, OperationRecorder, PowerReading
from laticauda.tank.operate.drivers import Frame

ROOT = Path(__file__).parents[3]


def campaign() -> Any:
    """campaigns/estimator.py as a module."""
    return campaign_scripts.campaign("estimator")


@cache
def swimming(
    robot: str = "mamba", duration: float = 10.0, current: tuple[float, float] = (0.0, 0.0)
) -> lc.Trial:
    """A straight swim with servo joints, sampled at 100 Hz."""
    from dataclasses import replace

    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.2, phase_shift=0.7)
    water = replace(lc.load_water("paper-lateral"), current=current)
    body = lc.build_plant(lc.load_robot(robot), water, joints="servo")
    return lc.run(body, lc.OpenLoop(command=lc.Command(gait=gait)), duration, sample_interval=0.01)


def perfect() -> Any:
    """Sensors without any fault."""
    return campaign().Sensors(
        position=0.0,
        yaw=0.0,
        joint=0.0,
        backlash=0.0,
        torque=0.0,
        lost=0.0,
        outliers=0.0,
        between=math.inf,
    )


IDLE = 1.2  # A
DRAWN = 3.0  # A


def follower() -> lc.PathFollowing:
    """The controller of the recordings."""
    return lc.PathFollowing(
        gait=lc.lateral_undulation(amplitude=0.5, frequency=2.2, phase_shift=0.7),
        path=lc.Polyline(waypoints=((0.0, 0.3), (3.0, 0.5), (6.0, 0.0))),
        guidance=lc.IntegralLineOfSight(look_ahead_distance=0.4, integral_gain=0.1),
        heading=lc.HeadingController(gain=0.4, max_offset=0.3),
        heading_estimate="cycle_mean",
    )


def record(
    path: Path, *, duration: float = 3.0, estimator: Any = None, torque: bool = True
) -> lc.Trial:
    """Record an operation: a swim, its samples, the estimates, and what a controller decides on them.

    The meter says DRAWN all the time; the run is from 1 s on, up to 0.5 s before the end.
    """
    trial = swimming(duration=duration)
    arrivals, _ = campaign().sense(trial, campaign().Sensors(between=4.0), 5)
    estimator = estimator or Estimator(robot=trial.robot, backlash=campaign().BACKLASH)
    controller = follower()
    header = Header(
        run=Experiment(robot=trial.robot, environment=trial.environment, gait=trial.gait),
        controller=controller,
        estimator=estimator,
        supply_voltage=35.0,
        operation="kind = 'operation'\n",
    )
    state, thought, at = estimator.init(), controller.init(), 0
    stop = duration - 0.5
    with OperationRecorder(path, header) as recorder:
        recorder.note("idle", {"current": IDLE})
        for k, now in enumerate(trial.time.tolist()):
            while at < len(arrivals) and arrivals[at][0] <= now + 1e-9:
                arrival, sample = arrivals[at]
                if not torque and hasattr(sample, "torque"):
                    sample = type(sample)(time=sample.time, angle=sample.angle)
                state = estimator.step(state, sample)
                recorder.record(sample, received=arrival)
                at += 1
            if k == 100:
                recorder.record(Event(time=now, kind="start", message="The run begins."))
            if k % 50 == 0:
                recorder.record(PowerReading(time=now, current=2.0, average=DRAWN, since=0.0))
                recorder.record(Frame(now, 0x181, bytes([k % 256]), is_ours=True, message=None))
            estimate = estimator.estimate(state, now)
            if estimate is not None:
                recorder.record(estimate)
                if k >= 100 and k % 5 == 0 and now <= stop:
                    thought, command = controller.step(thought, estimate)
                    signals = controller.signals(thought)
                    recorder.record(Decision(time=now, command=command, signals=signals))
            if abs(now - stop) < 1e-6:
                recorder.record(
                    Event(
                        time=now,
                        kind="stop",
                        message="The end of the tank.",
                        data={"succeeded": True},
                    )
                )
    return trial
