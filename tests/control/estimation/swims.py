"""What is seen of robots that swim, exactly, as samples."""

import math

import numpy as np

import laticauda as lc
from laticauda.control.estimation import JointSample, PoseSample, ReferenceSample
from laticauda.robot.kinematics import Posture, turn
from laticauda.scenarios.interfaces import Command, Start

GAIT = lc.lateral_undulation(
    amplitude=math.radians(30), frequency=math.radians(120), phase_shift=math.radians(40)
)


def swum(*ways):
    """What a robot that does one way after the other, each a robot, its water and how long, is seen to do."""
    state, found = None, []
    command = Command(gait=GAIT)
    for body, water, duration in ways:
        plant = lc.build_plant(body, water)
        state = plant.init(Start(), command) if state is None else state
        state, log, trouble = plant.march(state, command, duration, 0.02)
        assert trouble is None
        marker = Posture(body, log.center_of_mass, log.link_angle).link_centers[:, 0]
        kept = slice(len(found) and 1, None)
        found += [
            (time, angle, place, float(yaw))
            for time, angle, place, yaw in zip(
                log.time[kept],
                log.joint_angle[kept],
                marker[kept],
                log.link_angle[kept, 0],
                strict=True,
            )
        ]
    return found


def samples(seen, asked=0.52):
    """The same as samples; references are those of a wave of this amplitude, all the same for all joints [rad]."""
    for time, angle, place, yaw in seen:
        yield JointSample(time=time, angle=angle)
        yield PoseSample(time=time, position=np.append(place, 0.0), rotation=turn("yaw", yaw))
        wave = asked * math.sin(GAIT.frequency * time)
        yield ReferenceSample(time=time, angle=np.full(angle.size, wave), frequency=GAIT.frequency)


def jammed(seen, share=0.0, begin=15.0):
    """Joint 4 swings by a share of what it did from a time on [s]."""
    stuck = next(angle[3] for time, angle, _, _ in seen if time >= begin)
    change = np.arange(8) == 3
    return [
        (time, np.where(change & (time >= begin), stuck + share * (angle - stuck), angle), *pose)
        for time, angle, *pose in seen
    ]
