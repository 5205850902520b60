"""Mamba with its fin follows a smooth path through five waypoints.

Guidance computes a reference heading, and the heading controller an offset of the
gait; `run` closes the loop with any plant. The log of the run also contains the
controller's signals. Water and joints are those that were identified on the robot.

    python examples/03_follow_a_path.py
"""

from math import degrees, radians

import laticauda as lc
from laticauda.trials import following

controller = lc.PathFollowing(
    gait=lc.lateral_undulation(
        amplitude=radians(30), frequency=radians(90), phase_shift=radians(40)
    ),
    path=lc.Spline(
        waypoints=((0.0, 0.0), (3.0, 0.0), (5.0, 1.5), (7.0, 3.0), (10.0, 3.0))
    ),
    guidance=lc.LineOfSight(look_ahead_distance=0.18),
    heading=lc.HeadingController(gain=0.4, max_offset=radians(20)),
)
swimmer = lc.build_scenario(
    "mamba-fin", controller.gait, parameters="mamba-identified"
)
plant = lc.build_plant(swimmer)
trial = lc.run(plant, controller, 50.0, start=lc.Start(center_of_mass=(0.0, 0.8)))

error = trial.signals["cross_track_error"]
distance = trial.signals["along_track_distance"]
period = trial.period
arrival = following.convergence(trial.time, error, distance, period)
error_then = following.steady_error(trial.time, error, period, arrival.time)
largest_offset = abs(trial.signals["offset"]).max()
print(f"swam {distance[-1]:.1f} m of the path's {controller.path.length:.1f} m")
print(f"within 0.1 m of it after {arrival.distance:.2f} m, {arrival.time:.0f} s")
print(f"mean distance then: {error_then:.3f} m")
print(f"largest offset: {degrees(largest_offset):.1f} deg")
trial.plot().savefig("follow.png")
