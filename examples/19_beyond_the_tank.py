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

lateral = lc.lateral_undulation(
    amplitude_deg=30, frequency_deg_s=90, phase_shift_deg=40
)
eel = lc.eel_like(amplitude_deg=40, frequency_deg_s=90, phase_shift_deg=40)
near = lc.LineOfSight(look_ahead_distance=0.18)
far = lc.LineOfSight(look_ahead_distance=1.62)
integral = lc.IntegralLineOfSight(look_ahead_distance=1.62, integral_gain=0.12)
laws = {
    "line of sight": (far, 0.25),
    "its integral": (integral, 0.25),
    "the paper's gains": (near, 0.4),
}
figure, (drift, bend, turn) = new_panels(3, width=9.0, height=3.6)


def follow(path, gait, guidance, gain, interval):
    heading = lc.HeadingController(gain=gain, max_offset=radians(20))
    return lc.PathFollowing(
        gait=gait, path=path, guidance=guidance, heading=heading, interval=interval
    )


def show_error(ax, name, trial):
    error = trial.time, trial.signals["cross_track_error"], trial.period
    time, mean = following.mean_error(*error)
    ax.plot(time, 100 * mean, label=name)
    last_third = following.last_third_error(*error)
    rms = following.steady_error(*error, trial.duration * 2 / 3)
    print(
        f"{name}: {100 * last_third:.1f} cm in the last third, rms {100 * rms:.1f}, "
        f"at most {100 * abs(mean).max():.1f} cm"
    )


water = replace(lc.load_water("paper-lateral"), current=(0.0, 0.05))
plant = lc.build_plant(lc.load_robot("mamba-fin"), water)
for name, (guidance, gain) in laws.items():
    controller = follow(lc.StraightLine(), lateral, guidance, gain, 0.05)
    trial = lc.run(plant, controller, 180.0)
    show_error(drift, name, trial)
    upstream = guidance.look_ahead_distance * np.tan(trial.sideslip)
    print(f"  Delta tan(sideslip): {100 * upstream:.1f} cm")

path = lc.Spline(
    waypoints=((0.0, 0.0), (2.0, 1.0), (4.0, 0.0), (6.0, -1.0), (8.0, 0.0))
)


def is_at_end(observation):
    return observation.center_of_mass[0] >= 8.0


_, frame = path.locate(path.init(), np.zeros(2))
start = lc.Start(heading=frame.path_tangential_angle)
offsets = np.arange(4.0, 24.0, 4.0)
for robot, gait, water in (
    ("mamba", lateral, "paper-lateral"),
    ("mamba-fin", lateral, "paper-lateral"),
    ("mamba", eel, "paper-eel"),
    ("mamba-fin", eel, "paper-eel"),
):
    name = f"{gait.words}, {robot}"
    plant = lc.build_plant(lc.load_robot(robot), lc.load_water(water))
    controller = follow(path, gait, near, 0.4, 0.1)
    trial = lc.run(plant, controller, 150.0, start=start, until=is_at_end)
    show_error(bend, name, trial)
    turns = []
    for offset in offsets:
        command = lc.Command(gait=replace(gait, offset=radians(offset)))
        turns.append(lc.run(plant, lc.OpenLoop(command=command), 60.0))
    rates = np.degrees([trial.turning_rate for trial in turns])
    print(
        f"  turns by {min(rates / offsets):.2f} to {max(rates / offsets):.2f} "
        "deg/s per degree"
    )
    radii = [trial.path_speed for trial in turns] / np.radians(rates)
    turn.plot(offsets, radii, marker=".", label=name)
style.style_axes(drift, xlabel="time [s]", ylabel="error in a current [cm]")
style.style_axes(bend, xlabel="time [s]", ylabel="error along bends [cm]")
style.style_axes(turn, xlabel="offset [deg]", ylabel="radius of the turn [m]")
for ax in (drift, bend, turn):
    ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), **style.LEGEND)
save_figure(figure, "beyond-the-tank.png")
