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
along = [
    0.6245,
    *(at for k in range(6, 1, -1) for at in (k * link, k * link - 0.0545)),
    link,
    link - 0.053,
]
seen = Track.read(PRESETS / "tracks" / "amphibot-1.csv")
time, gap = marker_distance(trial, seen, along, fitted=(0.4, 1.1))

middles = {"seen": (seen.time, seen.place.mean(axis=1))}
middles["simulated"] = trial.time, marker_places(trial, along).mean(axis=1)
figure, (left, right) = new_panels(2, height=2.8)
for name, (when, middle) in middles.items():
    place = [np.interp(seen.time, when, one) for one in middle.T]
    way = np.hypot(*(one - one[0] for one in place))
    left.plot(seen.time, way, label=name)
    now = (seen.time > 2.2) & (seen.time < 4.5)
    print(
        f"{name}: {np.polyfit(seen.time[now], way[now], 1)[0]:.2f} m/s from 2.2 "
        "to 4.5 s"
    )
right.plot(time, 1000 * gap)
style.style_axes(left, xlabel="time [s]", ylabel="distance from the start [m]")
style.add_legend(left)
style.style_axes(right, xlabel="time [s]", ylabel="RMS distance of the LEDs [mm]")
save_figure(figure, "amphibot.png")
print(
    f"the LEDs are {1000 * np.interp(4.5, time, gap):.0f} mm apart at 4.5 s, "
    "where the robot is 2 m from its start"
)
