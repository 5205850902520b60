"""Mamba swims by lateral undulation for half a minute, as in a trial of the paper.

The robot and the gait are data; `swim` runs the planar model and returns a `Trial`,
the log of the run. The numbers of water and joints are those that were identified on
the robot.

    python examples/01_swim.py
"""

from math import radians

import laticauda as lc

robot = lc.load_robot("mamba")
gait = lc.lateral_undulation(
    amplitude=radians(30), frequency=radians(130), phase_shift=radians(40)
)
trial = lc.swim(robot, gait, duration=30.0, parameters="mamba-identified")

print(f"speed:          {trial.forward_velocity:.3f} m/s (measured: 0.151 m/s)")
print(f"power:          {trial.mean_power:.0f} W (measured: 107 W)")
print(f"servos use:     {trial.utilization:.0%} of what they can do")
print(f"end of the run: {trial.center_of_mass[-1].round(2)} m")
trial.plot().savefig("swim.png")
