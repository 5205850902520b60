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

error, along = (
    trial.signals["cross_track_error"],
    trial.signals["along_track_distance"],
)
reached = following.convergence(trial.time, error, along, trial.period)
print(f"swam {along[-1]:.1f} m of the path's {controller.path.length:.1f} m")
print(f"within 0.1 m of it after {reached.distance:.2f} m, {reached.time:.0f} s")
print(
    "mean distance then: "
    f"{following.steady_error(trial.time, error, trial.period, reached.time):.3f} m"
)
print(f"largest offset: {degrees(abs(trial.signals['offset']).max()):.1f} deg")
trial.plot().savefig("follow.png")
