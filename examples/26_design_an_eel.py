"""Design an eel for one servo and one battery: body, fin and gait at once.

The battery has to last for 5 km; the servos may use half of what their maker says;
modules are filled up with ballast until they float in the water.

    python examples/26_design_an_eel.py
"""

from dataclasses import replace
from pathlib import Path

import laticauda as lc
from laticauda.robot import to_toml, with_servos
from laticauda.show.reports import write_design_sheet
from laticauda.studies import Optimization, judge_design, judge_point, optimize

eel = lc.load_robot(Path(__file__).parent / "eel.toml")
robot = with_servos(eel, "xw540-t140")
# Without ballast.
light_modules = tuple(replace(module, mass=0.45) for module in robot.modules)
light = replace(robot, modules=light_modules)
gait = lc.eel_like(amplitude=0.5, frequency=3.0, phase_shift=0.6)
optimization = Optimization(
    scenario=lc.build_scenario(light, gait, 8.0, ramp=2.0),
    bounds={
        "robot.module[:3].length": (0.09, 0.2),
        "robot.module[3:7].length": (0.09, 0.2),
        "robot.module[7:].length": (0.09, 0.2),
        "robot.module.section.half_height": (0.035, 0.06),
        "robot.module[:5].section.half_width": (0.03, 0.05),
        "robot.module[5:].section.half_width": (0.03, 0.05),
        "robot.caudal_fin.length": (0.08, 0.3),
        "robot.caudal_fin.height": (0.06, 0.2),
        "gait.amplitude[0]": (0.1, 0.9),
        "gait.amplitude[1:4]": (0.1, 0.9),
        "gait.amplitude[4:]": (0.05, 0.9),
        "gait.phase_shift": (0.2, 1.2),
        "gait.frequency": (1.0, 8.0),
    },
    objectives="forward_velocity",
    battery=60.0,
    battery_range=5000.0,
    servo_share=0.5,
    most_mass=7.0,
    ballast=True,
    length_step=0.001,
)
front = optimize(optimization, budget=600, seed=1)
before = judge_design(optimization)
after = judge_point(optimization, front.values[0])
print(f"{front.n_trials} points, {front.n_slope_trials} trials for slopes")
for title, design in (("before", before), ("after", after)):
    print(f"{title}: {design.trial.forward_velocity:.3f} m/s")
    for use in design.uses:
        print(f"   {use.limit}: {100 * use.share:.0f} %, {use.description}")
print("it comes up against:", ", ".join(after.active))
designed = replace(after.scenario.robot, name="eel-design")
with_servos_as_they_are = lc.swim(
    designed, after.scenario.gait, 8.0, joints="servo"
)
speed = with_servos_as_they_are.forward_velocity
power = with_servos_as_they_are.mean_power + designed.idle_power
print(
    f"with servos that follow the gait as they can: {speed:.3f} m/s, {power:.1f} W"
)
Path("eel-design.toml").write_text(to_toml(designed), encoding="utf-8")
design = replace(after.scenario, robot=designed)
write_design_sheet(before.scenario, design, "eel-design.png")
