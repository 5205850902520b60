"""Mamba with its fin plans its way along a line, in a cross current half as fast
as the robot swims.

Four trials provide the model of how the gait moves the robot. The plan steers
and chooses the frequency, within 15 W.

    pip install ".[mpc]"
    python examples/13_mpc.py
"""

from dataclasses import replace
from math import degrees, radians

import laticauda as lc
from laticauda.control import ModelPredictive
from laticauda.show.figures import new_panels, save_figure, style
from laticauda.studies import averaged_model
from laticauda.trials import following

gait = lc.lateral_undulation(
    amplitude=radians(30), frequency=radians(90), phase_shift=radians(40)
)
robot = lc.load_robot("mamba-fin")
water = lc.load_water("paper-lateral")
frequency_limits = (radians(60), radians(120))
# Fitted to four trials that it runs itself.
model = averaged_model(lc.build_plant(robot, water), gait, frequency_limits)

plan = ModelPredictive(
    gait=gait,
    path=lc.StraightLine(),
    model=model,
    speed=0.12,
    frequency_limits=frequency_limits,
    power_limit=15.0,
)
line_of_sight = lc.PathFollowing(
    gait=gait,
    path=lc.StraightLine(),
    guidance=lc.LineOfSight(look_ahead_distance=0.18),
    heading=lc.HeadingController(gain=0.4, max_offset=radians(20)),
)
plant = lc.build_plant(robot, replace(water, current=(0.0, 0.06)))
start = lc.Start(center_of_mass=(0.0, 0.5))
figure, (ax,) = new_panels(height=2.6)
for name, controller in (("line of sight", line_of_sight), ("plan", plan)):
    trial = lc.run(plant, controller, 90.0, start=start)
    error = trial.signals["cross_track_error"]
    distance = trial.signals["along_track_distance"][-1]
    last_error = following.last_third_error(trial.time, error, trial.period)
    print(
        f"{name}: {100.0 * last_error:.1f} cm beside the line, "
        f"{distance:.1f} m along it"
    )
    ax.plot(trial.time, 100.0 * error, label=name)
frequency = degrees(trial.signals["frequency"][-1])  # in the plan's trial
drift = trial.signals["drift_y"][-1]
print(
    f"the plan swims at {frequency:.0f} deg/s and reckons with a drift of "
    f"{drift:.3f} m/s"
)
style.style_axes(ax, xlabel="time [s]", ylabel="cross-track error [cm]")
style.add_legend(ax)
save_figure(figure, "plan.png")
