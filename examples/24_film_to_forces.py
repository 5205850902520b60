"""What does a swimming eel's body do to the water, from points tracked in a film?

python examples/24_film_to_forces.py
"""

import matplotlib.pyplot as plt
import numpy as np

import laticauda as lc
from laticauda.film import TrackedPoints
from laticauda.film.chain import build_eel
from laticauda.film.forces import invert_points
from laticauda.robot import textbook_water
from laticauda.trials.markers import marker_places

# Instead of a camera: an eel of 40 cm swims, and a tracker sees nine points on it at
# 60 frames per second, with 1 mm of noise; 2 % of the points are somewhere else.
eel = build_eel(0.4)
gait = lc.eel_like(amplitude=0.5, frequency=9.0, phase_shift=0.65)
truth = textbook_water(eel).water
swim = lc.swim(eel, gait, 9.0, environment=truth, sample_interval=1 / 60)
filmed = swim.time > 5.0
along = [0.39, 0.35, 0.3, 0.24, 0.19, 0.14, 0.09, 0.05, 0.01]  # m from the tail tip
positions = marker_places(swim, along)[filmed]
rng = np.random.default_rng(1)
positions = positions + 0.001 * rng.standard_normal(positions.shape)
jumps = rng.random(positions.shape[:2]) < 0.02
positions[jumps] += 0.1 * rng.standard_normal((jumps.sum(), 2))
points = TrackedPoints(
    time=swim.time[filmed],
    names=tuple(f"point {number}" for number in range(9)),
    position=positions,
    likelihood=np.full(positions.shape[:2], np.nan),
    unit="m",
)

# A real file is read by `laticauda.film.read_points`. The water is that of tables.
forces = invert_points(points, eel, along, n_draws=100)
window = forces.window
true_work = np.interp(window.time[[0, -1]], swim.time, swim.work[:, 0])
true_power = (true_work[1] - true_work[0]) / window.duration
for name in ("speed", "mechanical_power", "froude_efficiency", "left_over_share"):
    value = forces.figures[name]
    sources = [f"{source} {share:.0%}" for source, share in value.shares.items()]
    print(
        f"{value.title:30} {value.median:.3g} "
        f"({value.low:.3g} to {value.high:.3g}) {value.unit}"
    )
    print(f"{'':30} from {', '.join(sources)}")
print(f"true power {true_power:.3g} W; places left out: {forces.fit.n_outliers}")

figure, (curves, bars) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
motion = forces.fit.motion(window.time)
draws = np.degrees(forces.fit.draw(100, motion.time).joint_angle)
low, high = np.percentile(draws, (2.5, 97.5), axis=0)
for joint, color in ((0, "C0"), (4, "C1"), (8, "C2")):
    angle = np.degrees(motion.joint_angle[:, joint])
    curves.plot(motion.time, angle, color=color, label=f"joint {joint + 1}")
    band = low[:, joint], high[:, joint]
    curves.fill_between(motion.time, *band, color=color, alpha=0.25, linewidth=0)
    true_angle = np.degrees(swim.joint_angle[filmed, joint])
    curves.plot(swim.time[filmed], true_angle, "k:", linewidth=1)
curves.set_xlim(*window.time[[0, -1]])
curves.set_xlabel("time [s]")
curves.set_ylabel("joint angle [deg]")
curves.set_title("fit with its 95 % band; dotted: true", fontsize="medium")
curves.legend(
    loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=3, frameon=False
)
links = forces.link_figures
median = np.array([force.median for force in links])
below = median - [force.low for force in links]
above = [force.high for force in links] - median
numbers = np.arange(1, len(links) + 1)
bars.bar(numbers, 1e3 * median, yerr=[1e3 * below, 1e3 * above], color="C0")
bars.axhline(0.0, color="gray", linewidth=0.8)
bars.set_xlabel("link, from the tail")
bars.set_ylabel("mean force along the way [mN]")
bars.set_title("thrust above 0, drag below; 95 % intervals", fontsize="medium")
figure.savefig("film_to_forces.png", dpi=150)
