"""Beyond the experiments in the paper's tank: a current across the path, a path
with bends, and turns with a constant offset.

In a current, only an error makes line of sight point upstream, unless it
integrates. In bends, it runs wide.

    python examples/19_beyond_the_tank.py
"""

from dataclasses import replace
from math import radians

import numpy as np

import laticauda as lc
from laticauda.show.figures import new_panels, save_figure, style
from laticauda.trials import following

rate = {"frequency_deg_s": 90, "phase_shift_deg": 40}
lateral = (
    lc.lateral_undulation(amplitude_deg=30, **rate),
    lc.load_water("paper-lateral"),
)
eel = lc.eel_like(amplitude_deg=40, **rate), lc.load_water("paper-eel")
swimmers = [
    (robot, *how) for how in (lateral, eel) for robot in ("mamba", "mamba-fin")
]
near, far = (
    lc.LineOfSight(look_ahead_distance=distance) for distance in (0.18, 1.62)
)
integral = lc.IntegralLineOfSight(look_ahead_distance=1.62, integral_gain=0.12)
laws = {
    "line of sight": (far, 0.25),
    "its integral": (integral, 0.25),
    "the paper's gains": (near, 0.4),
}
figure, (drift, bend, turn) = new_panels(3, width=9.0, height=3.6)


def steady(gait):
    return lc.OpenLoop(command=lc.Command(gait=gait))


def follow(ax, name, plant, gait, guidance, gain, duration, interval, path, **more):
    heading = lc.HeadingController(gain=gain, max_offset=radians(20))
    steered = lc.PathFollowing(
        gait=gait, path=path, guidance=guidance, heading=heading, interval=interval
    )
    trial = lc.run(plant, steered, duration, **more)
    error = trial.time, trial.signals["cross_track_error"], trial.period
    middle, mean = following.mean_error(*error)
    ax.plot(middle, 100 * mean, label=name)
    kept, rms = (
        following.last_third_error(*error),
        following.steady_error(*error, trial.duration * 2 / 3),
    )
    print(
        f"{name}: {100 * kept:.1f} cm in the last third, rms {100 * rms:.1f}, at "
        f"most {100 * abs(mean).max():.1f} cm"
    )
    return trial


plant = lc.build_plant(
    lc.load_robot("mamba-fin"), replace(lateral[1], current=(0.0, 0.05))
)
for name, law in laws.items():
    trial = follow(
        drift, name, plant, lateral[0], *law, 180.0, 0.05, lc.StraightLine()
    )
    print(
        "  Delta tan(sideslip): "
        f"{100 * law[0].look_ahead_distance * np.tan(trial.sideslip):.1f} cm"
    )

path = lc.Spline(
    waypoints=((0.0, 0.0), (2.0, 1.0), (4.0, 0.0), (6.0, -1.0), (8.0, 0.0))
)
start = lc.Start(
    heading=path.locate(path.init(), np.zeros(2))[1].path_tangential_angle
)
offsets = np.arange(4.0, 24.0, 4.0)
for robot, gait, water in swimmers:
    name, plant = (
        f"{gait.words}, {robot}",
        lc.build_plant(lc.load_robot(robot), water),
    )
    ends = {"start": start, "until": lambda seen: seen.center_of_mass[0] >= 8.0}
    follow(bend, name, plant, gait, near, 0.4, 150.0, 0.1, path, **ends)
    turns = [
        lc.run(plant, steady(replace(gait, offset=radians(one))), 60.0)
        for one in offsets
    ]
    rates = np.degrees([one.turning_rate for one in turns])
    print(
        f"  turns by {min(rates / offsets):.2f} to {max(rates / offsets):.2f} "
        "deg/s per degree"
    )
    turn.plot(
        offsets,
        [one.path_speed for one in turns] / np.radians(rates),
        marker=".",
        label=name,
    )
style.style_axes(drift, xlabel="time [s]", ylabel="error in a current [cm]")
style.style_axes(bend, xlabel="time [s]", ylabel="error along bends [cm]")
style.style_axes(turn, xlabel="offset [deg]", ylabel="radius of the turn [m]")
for ax in (drift, bend, turn):
    ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), **style.LEGEND)
save_figure(figure, "beyond-the-tank.png")
