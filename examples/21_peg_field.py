"""Obstacle-aided locomotion: where friction is the same in all directions, the
robot moves by pushing against obstacles.

On such ground a body wave makes no headway; in a field of pegs the robot pushes
itself along. The same holds under water if the drag is the same in all directions.
This example needs the extra `spatial`.

    python examples/21_peg_field.py
"""

from dataclasses import replace
from math import pi, radians

import numpy as np

import laticauda as lc
from laticauda.models.spatial.scene import HeightField
from laticauda.show.figures import new_panels, save_figure, style

robot = lc.load_robot("mamba-modules")
gait = lc.lateral_undulation(
    amplitude=radians(30), frequency=radians(60), phase_shift=radians(40)
)
bare = lc.Ground(
    friction=lc.CoulombFriction(regularization_speed=1e-2),
    tangential=0.1,
    normal=0.1,
)
section = robot.modules[0].section
# C_f as a share of C_D, for c_t = c_n
share = (
    4.0 * section.half_height / (pi * (section.half_height + section.half_width))
)
plain = replace(
    lc.load_water("paper-lateral"),
    density=robot.mass / robot.volume,
    normal_drag=1.0,
    tangential_friction=share,
    added_mass=0.0,
    added_inertia=0.0,
)
figure, (ax,) = new_panels(height=2.8)
for place, environment in (("on land", bare), ("under water", plain)):
    for scene in (None, "pegs"):
        trial = lc.swim(
            robot, gait, 15.0, environment=environment, model="spatial", scene=scene
        )
        around = "pegs" if scene else "nothing"
        ax.plot(trial.time, trial.center_of_mass[:, 0], label=f"{place}, {around}")
        way = trial.center_of_mass[-1, 0] - trial.center_of_mass[0, 0]
        print(
            f"{place}, {'open' if scene is None else 'pegs'}: {way:+.2f} m in 15 s"
        )
    force = np.linalg.norm(trial.link_force["contact"], axis=2)
    print(
        f"   {force.sum(axis=1).mean():.0f} N of contact on average, up to "
        f"{force.max():.0f} N on one link"
    )
    # laticauda view pegs-on-land.nc --video pegs.mp4
    trial.save(f"pegs-{place.replace(' ', '-')}.nc")
style.style_axes(ax, xlabel="time [s]", ylabel="distance [m]")
style.add_legend(ax, loc="upper left")
save_figure(figure, "pegs.png")

skin = replace(bare, normal=0.5)
for scene in (None, HeightField(amplitude=0.03), HeightField(amplitude=0.06)):
    trial = lc.swim(
        robot, gait, 10.0, environment=skin, model="spatial", scene=scene
    )
    way = trial.center_of_mass[-1, 0] - trial.center_of_mass[0, 0]
    print(
        f"waves of {0.0 if scene is None else scene.amplitude:.2f} m in the "
        f"ground: {way:+.2f} m in 10 s"
    )
