"""A short whole trial in a virtual tank, for the tests of the drivers."""

import math

import laticauda as lc
from laticauda.tank import lab
from laticauda.tank.operate.session import operate
from laticauda.tank.operate.settings import (
    Acceptance,
    Calibration,
    CaptureVolume,
    Connection,
    Limits,
    Operation,
)

# A computer that is busy with other tests is late; that is not what is tested here.
PATIENT = Limits(
    straighten_time=1.0,
    joint_error_time=15.0,
    max_lateness=5.0,
    joint_timeout=15.0,
    heartbeat_timeout=15.0,
    mocap_timeout=15.0,
)


def run_trial(virtual_lab: lab.Lab, folder, *, bus: str = "", mocap: str = "", **settings):
    """Operate the robot in a tank, whose other devices are those of laticauda."""
    drivers = {}
    if bus:
        drivers["bus"] = bus
    if mocap:
        drivers["mocap"] = mocap
    with virtual_lab as addresses:
        connection = Connection(
            mocap_address=f"{addresses.mocap_host}:{addresses.mocap_port}", mocap_body=lab.BODY
        )
        operation = Operation(
            name="whole",
            gait=lc.lateral_undulation(
                amplitude=math.radians(20), frequency=math.radians(90), phase_shift=math.radians(40)
            ),
            duration=2.0,
            rate=20.0,
            countdown=0.1,
            tank=CaptureVolume(volume_x=(-1.0, 11.0)),
            connection=connection.at(**drivers),
            calibration=Calibration(joint_zeros=True, idle_time=0.2, still_time=0.5),
            limits=PATIENT,
            # It is still for a moment only, and on a busy computer devices answer late, at 20 Hz by
            # many degrees.
            acceptance=Acceptance(water_speed=0.1, pose_age=2.0, angle_jump=math.radians(10.0)),
            **settings,
        )
        return operate(operation, folder)
