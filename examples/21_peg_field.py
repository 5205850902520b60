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
water = replace(
    lc.load_water("paper-lateral"),
    density=robot.mass / robot.volume,
    normal_drag=1.0,
    tangential_friction=share,
    added_mass=0.0,
    added_inertia=0.0,
)
figure, (ax,) = new_panels(height=2.8)
for place, environment in (("on land", bare), ("under water", water)):
    for around, scene in (("nothing", None), ("pegs", "pegs")):
        trial = lc.swim(
            robot, gait, 15.0, environment=environment, model="spatial", scene=scene
        )
        x = trial.center_of_mass[:, 0]
        ax.plot(trial.time, x, label=f"{place}, {around}")
        title = "pegs" if scene else "open"
        print(f"{place}, {title}: {x[-1] - x[0]:+.2f} m in 15 s")
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
for amplitude in (0.0, 0.03, 0.06):
    scene = None
    if amplitude > 0.0:
        scene = HeightField(amplitude=amplitude)
    trial = lc.swim(
        robot, gait, 10.0, environment=skin, model="spatial", scene=scene
    )
    x = trial.center_of_mass[:, 0]
    print(
        f"waves of {amplitude:.2f} m in the ground: {x[-1] - x[0]:+.2f} m in 10 s"
    )
