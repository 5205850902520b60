"""A robot for which nothing was fitted: AmphiBot's recorded run 1, simulated from
its measured joint angles.

campaigns/amphibot.py computes all figures of this run and compares them with
models without hydrodynamics.

python examples/16_amphibot.py
"""

import numpy as np

import laticauda as lc
from laticauda.robot.files import PRESETS
from laticauda.show.figures import new_panels, save_figure, style
from laticauda.trials.markers import Track, marker_distance, marker_places

# The water comes from textbook tables: friction of skin, nose and gaps; drag and
# added mass of an elliptic section.
gait = lc.recorded_gait(lc.load_joint_angles("amphibot-1"))
trial = lc.swim("amphibot", gait, 13.0, dt=0.005, sample_interval=0.02)

# The 13 LEDs from head to tail: distance from the tail end along the straight
# body.
link = 0.0965
led_positions = [0.6245]
for k in range(6, 1, -1):
    led_positions += [k * link, k * link - 0.0545]
led_positions += [link, link - 0.053]
track = Track.read(PRESETS / "tracks" / "amphibot-1.csv")
time, gap = marker_distance(trial, track, led_positions, fitted=(0.4, 1.1))


def distance_from_start(time, leds):
    """Return how far the middle of the LEDs is from its start, at the track's times."""
    x, y = leds.mean(axis=1).T
    x = np.interp(track.time, time, x)
    y = np.interp(track.time, time, y)
    return np.hypot(x - x[0], y - y[0])


distances = {
    "seen": distance_from_start(track.time, track.place),
    "simulated": distance_from_start(
        trial.time, marker_places(trial, led_positions)
    ),
}
figure, (left, right) = new_panels(2, height=2.8)
is_steady = (track.time > 2.2) & (track.time < 4.5)
for name, distance in distances.items():
    left.plot(track.time, distance, label=name)
    speed, _ = np.polyfit(track.time[is_steady], distance[is_steady], 1)
    print(f"{name}: {speed:.2f} m/s from 2.2 to 4.5 s")
right.plot(time, 1000 * gap)
style.style_axes(left, xlabel="time [s]", ylabel="distance from the start [m]")
style.add_legend(left)
style.style_axes(right, xlabel="time [s]", ylabel="RMS distance of the LEDs [mm]")
save_figure(figure, "amphibot.png")
print(
    f"the LEDs are {1000 * np.interp(4.5, time, gap):.0f} mm apart at 4.5 s, "
    "where the robot is 2 m from its start"
)
