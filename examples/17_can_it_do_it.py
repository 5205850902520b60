"""Can this robot do it? What Table 1's gaits take of Mamba's joints in the models, beside the servo that it has.

The robot swam all of them. So a row beyond its published servo (2.9 N m, 7.5 rad/s) says that the model's water or its
joints ask for too much, or that there is more gear between servo and joint than was published.

    python examples/17_can_it_do_it.py
"""

import math

import laticauda as lc
from laticauda.paper.measured import efficiency_trials
from laticauda.robot import load_parameters, parameter_names
from laticauda.trial.feasibility import feasibility

for name in parameter_names():
    model = load_parameters(name)
    print(f"\n{name}: {model.joints or 'prescribed'} joints")
    n_beyond, most = 0, 0.0
    for row in efficiency_trials():
        published = lc.load_robot(row.robot)
        robot, water = model.robot(published, row.gait.kind), model.water(row.gait.kind)
        trial = lc.swim(robot, row.gait, environment=water, joints=model.joints or "prescribed")
        found = feasibility(published, trial, trial.period)  # the same motion and torques, the published servo
        n_beyond += bool(found.problems)
        most = max(most, found.figures["peak_joint_torque"])
        setting = [math.degrees(angle) for angle in (row.gait.amplitude, row.gait.frequency, row.gait.phase_shift)]
        where = "{:9} {:18} {:3.0f} deg {:4.0f} deg/s {:3.0f} deg".format(row.robot, row.gait.words, *setting)
        print(f"  {where} {found.figures['utilization']:6.2f}  {'; '.join(found.problems) or 'feasible'}")
    print(f"  {n_beyond} of {len(efficiency_trials())} rows are beyond the servo; the largest torque is {most:.1f} N m")
