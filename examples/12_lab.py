"""Operate the virtual tank: the operator's program runs against simulated joint
modules, cameras and a power meter.

Here the operator and the tank share one process and are stepped, so nothing waits.
`make lab` runs them as two programs with a CAN bus, a network port and a serial
line between them; on the robot, `laticauda operate` is the same operator.

    python examples/12_lab.py
"""

from math import degrees, radians

import numpy as np

import laticauda as lc
from laticauda.control import Following
from laticauda.show.figures import new_panels, save_figure, style
from laticauda.tank.lab import Fault, LabSettings, Tank, VirtualRobot
from laticauda.tank.operate.loop import run_loop
from laticauda.tank.operate.procedure.operator import Operator
from laticauda.tank.operate.settings import (
    Calibration,
    CaptureVolume,
    Connection,
    Operation,
)
from laticauda.tank.operate.tank_devices import TankDevices

operation = Operation(
    name="desk",
    robot="mamba",
    parameters="mamba-identified",
    gait=lc.lateral_undulation(
        amplitude=radians(30), frequency=radians(90), phase_shift=radians(40)
    ),
    following=Following(look_ahead_distance=0.18, gain=0.4, max_offset=radians(20)),
    duration=15.0,
    rate=50.0,
    connection=Connection(meter_address="stepped"),
    supply_voltage=35.0,
    tank=CaptureVolume(volume_x=(-1.0, 11.0)),
    calibration=Calibration(joint_zeros=True),
)


def operate(*faults: Fault) -> None:
    """Run it in a tank with these faults, and print what happened."""
    robot = operation.body()
    plant = lc.build_plant(robot, operation.pool(), joints=operation.joint_law())
    tank = Tank(
        VirtualRobot(robot, plant, lc.Start(center_of_mass=(0.0, 0.8))),
        LabSettings(seed=1),
        faults,
    )

    estimated_path = []
    true_path = []

    def show(state, outputs) -> None:
        if state.estimate is not None:
            estimated_path.append(state.estimate.center_of_mass[:2])
            true_path.append(tank.truth.center_of_mass[:2])
        for event in outputs.events:
            if event.kind != "phase":
                print(f"{event.time:7.2f} s  {event.message}")

    state, _ = run_loop(Operator(operation=operation), TankDevices(tank), show=show)
    estimate = state.estimate
    truth = tank.truth
    print(
        f"p_y {estimate.center_of_mass[1]:.3f} m "
        f"(true {truth.center_of_mass[1]:.3f}), "
        f"heading {degrees(estimate.heading):.1f} deg "
        f"(true {degrees(truth.heading):.1f})"
    )
    print(
        f"at rest {state.idle.mean:.2f} A, swimming {state.drawn.mean:.2f} A; "
        f"{state.supervisor.state}\n"
    )
    case = "a leak" if faults else "no fault"
    ax.plot(*np.transpose(estimated_path), label=f"estimate, {case}")
    ax.plot(*np.transpose(true_path), "k:", linewidth=1)


figure, (ax,) = new_panels(height=2.8)
operate()
operate(Fault(kind="leak", time=20.0, node=4))
style.style_axes(ax, xlabel="x [m]", ylabel="y [m]")
style.add_title(figure, "Path of the center of mass; dotted: the truth")
style.add_legend(ax, loc="lower left")
save_figure(figure, "tank.png")
