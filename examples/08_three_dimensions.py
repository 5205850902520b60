"""Mamba in three dimensions: a pitching wave, a helix, a path in space, and
motion on the ground and from a shore into the water.

A gait can have a second wave, for the pitch joints. This example needs the extra
`spatial`.

    python examples/08_three_dimensions.py
"""

from dataclasses import replace
from math import pi, radians

import numpy as np

import laticauda as lc
from laticauda.models.spatial.scene import Shore
from laticauda.show.figures import new_panels, save_figure, style

robot = lc.load_robot("mamba-modules")
# neutrally buoyant
water = replace(lc.load_water("paper-lateral"), density=robot.mass / robot.volume)
yaw = lc.lateral_undulation(
    amplitude=radians(30), frequency=radians(120), phase_shift=radians(40)
)
wave = lc.Wave(
    amplitude=radians(30), frequency=radians(120), phase_shift=radians(40)
)
vertical = replace(yaw, amplitude=0.0, pitch=wave)
helix = replace(yaw, pitch=replace(wave, phase=pi / 2))
for name, gait in (("lateral", yaw), ("vertical", vertical), ("helix", helix)):
    trial = lc.swim(
        robot, gait, 20.0, environment=water, model="spatial", gravity=False
    )
    print(f"{name:8} undulation: {trial.forward_velocity:.3f} m/s")

controller = lc.SpatialPathFollowing(
    gait=yaw,
    path=lc.StraightLine(),
    # distance along the path, height
    profile=lc.Spline(
        waypoints=((0.0, -0.5), (2.0, -0.5), (5.0, -1.0), (12.0, -1.5))
    ),
    guidance=lc.LineOfSight(look_ahead_distance=0.5),
    climb_guidance=lc.LineOfSight(look_ahead_distance=1.0),
    heading=lc.HeadingController(gain=0.4, max_offset=radians(15)),
    climb=lc.HeadingController(gain=0.2, max_offset=radians(5)),
)
dive = lc.run(
    lc.build_plant(robot, water, model="spatial"),
    controller,
    60.0,
    start=lc.Start(center_of_mass=(0.0, 0.3)),
)
late = dive.time > 40.0
for name in ("cross_track_error", "height_error"):
    print(
        f"path in space, last third: {name} within "
        f"{100 * abs(dive.signals[name][late]).max():.1f} cm"
    )

figure, (ax,) = new_panels(height=2.6)
ax.plot(
    dive.center_of_mass[:, 0], dive.center_of_mass[:, 2], label="center of mass"
)
waypoints = np.transpose(controller.profile.waypoints)
ax.plot(*waypoints, marker="o", label="waypoints")
style.style_axes(ax, xlabel="x [m]", ylabel="height [m]")
style.add_legend(ax)
save_figure(figure, "dive.png")

# Friction that fades out below 1 cm/s instead of 1 mm/s allows time steps ten times
# as long.
snake_skin = lc.Ground(
    friction=lc.CoulombFriction(regularization_speed=1e-2),
    tangential=0.1,
    normal=0.5,
)
bare_skin = replace(snake_skin, tangential=0.4, normal=0.4)
sidewinding = replace(
    yaw,
    amplitude=radians(25),
    pitch=replace(wave, amplitude=radians(5), phase=pi / 2),
)
for name, gait, ground in (
    ("lateral undulation", yaw, snake_skin),
    ("sidewinding", sidewinding, bare_skin),
):
    trial = lc.swim(robot, gait, 10.0, environment=ground, model="spatial")
    way = trial.center_of_mass[-1] - trial.center_of_mass[0]
    forward, left, _ = way / trial.duration
    print(f"{name}: {forward:.2f} m/s forward, {left:.2f} m/s to the left")

shore = lc.build_plant(
    robot,
    lc.load_water("paper-lateral"),
    model="spatial",
    scene=Shore(ground=snake_skin),
)
start = lc.Start(center_of_mass=(1.6, 0.0))  # the shore ends at x = 2.5 m
trial = lc.run(shore, lc.OpenLoop(command=lc.Command(gait=yaw)), 20.0, start=start)
trial.save("shore.nc")  # laticauda view shore.nc --video shore.mp4
is_under_water = trial.center_of_mass[:, 2] < -0.05
diving_time = trial.time[np.argmax(is_under_water)]
distance = trial.center_of_mass[-1, 0] - 1.6
print(
    f"from the shore: under water after {diving_time:.1f} s, "
    f"{distance:.1f} m in 20 s"
)
