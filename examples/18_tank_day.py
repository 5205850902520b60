"""A tank day: from a robot on the table to its own water, with a verdict on the law
of the water.

A simulated robot stands in for the one in the tank. Its water is unknown to the
evaluation, and its measurements are noisy. In a lab,
`laticauda design-experiment --tank-day day` creates the folder, people fill it in,
and the same command evaluates it.

    python examples/18_tank_day.py
"""

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np

import laticauda as lc
from laticauda.identify import tank_day
from laticauda.identify.towing import Tow
from laticauda.motion.joints import SpeedServo
from laticauda.robot import textbook_water
from laticauda.robot.kinematics import Posture
from laticauda.show.figures import new_panels, save_figure, style

rng = np.random.default_rng(1)
folder = Path("day")
robot = lc.load_robot("amphibot")
truth = replace(
    textbook_water(robot).water, tangential_friction=0.06, normal_drag=1.9
)
tank_day.prepare_folder(folder, robot)


def log(name: str, trial: lc.Trial) -> None:
    """Fill a table as a lab would: the tail link by motion capture, encoders."""
    posture = Posture(robot, trial.center_of_mass, trial.link_angle)
    position = posture.link_centers[:, 0]
    position = position + rng.normal(0.0, 0.0045, position.shape)
    angles = np.column_stack((trial.link_angle[:, :1], trial.joint_angle))
    angles = angles + rng.normal(0.0, 0.005, angles.shape)
    rows = np.column_stack((trial.time, position, np.degrees(angles)))
    table = folder / f"{name}.csv"
    head = table.read_text().splitlines()[0]
    with table.open("w", newline="") as file:
        file.write(f"{head}\n")
        csv.writer(file).writerows(rows.tolist())


gait = lc.lateral_undulation(
    amplitude_deg=30, frequency_deg_s=120, phase_shift_deg=40
)
still = replace(gait, amplitude=0.0)
swim = lc.swim(
    robot, gait, 12.0, environment=truth, joints=SpeedServo(speed_limit=0.9)
)
log("swim", swim)
glide = lc.swim(
    robot,
    still,
    8.0,
    environment=truth,
    start=lc.Start(velocity=swim.forward_velocity),
)
log("glide", glide)
with (folder / "tows.csv").open() as file:
    head, *rows = csv.reader(file)
for row in rows:
    speed, angle = float(row[0]), float(row[1])
    tow = Tow(speed=speed, angle=math.radians(angle))
    loads = tow.loads(lc.build_scenario(robot, still, environment=truth))
    row[2:] = [str(load + rng.normal(0.0, 0.03)) for load in loads.values()]
with (folder / "tows.csv").open("w", newline="") as file:
    csv.writer(file).writerows([head, *rows])

day = tank_day.load_day(folder)
evaluation = tank_day.evaluate(day)
print(tank_day.format_evaluation(evaluation))
print(
    f"in truth: C_f 0.06, C_D 1.9, C_A {truth.added_mass:.3g}, beta 0.5, "
    "kirchhoff; joints at most 0.9 rad/s"
)
tank_day.write_result(folder, day, evaluation)

figure, (ax,) = new_panels(height=2.6)
for name, trial in (("swim", swim), ("glide", glide)):
    ax.plot(trial.time, trial.center_of_mass[:, 0], label=name)
style.style_axes(ax, xlabel="time [s]", ylabel="distance [m]")
style.add_legend(ax)
save_figure(figure, "day.png")
