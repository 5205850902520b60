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
places = marker_places(swim, along)[filmed]
chance = np.random.default_rng(1)
places = places + 0.001 * chance.standard_normal(places.shape)
jumps = chance.random(places.shape[:2]) < 0.02
places[jumps] += 0.1 * chance.standard_normal((jumps.sum(), 2))
points = TrackedPoints(
    time=swim.time[filmed],
    names=tuple(f"point {number}" for number in range(9)),
    position=places,
    likelihood=np.full(places.shape[:2], np.nan),
    unit="m",
)

# A real file is read by `laticauda.film.read_points`. The water is that of tables.
forces = invert_points(points, eel, along, n_draws=100)
begin, end = (
    np.interp(t, swim.time, swim.work[:, 0]) for t in forces.window.time[[0, -1]]
)
true_power = (end - begin) / forces.window.duration
for name in ("speed", "mechanical_power", "froude_efficiency", "left_over_share"):
    one = forces.figures[name]
    where = ", ".join(
        f"{source} {share:.0%}" for source, share in one.shares.items()
    )
    print(
        f"{one.title:30} {one.median:.3g} ({one.low:.3g} to {one.high:.3g}) {one.unit}"
    )
    print(f"{'':30} from {where}")
print(f"true power {true_power:.3g} W; places left out: {forces.fit.n_outliers}")

figure, (curves, bars) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
shown = forces.fit.motion(forces.window.time)
draws = np.degrees(forces.fit.draw(100, shown.time).joint_angle)
low, high = np.percentile(draws, (2.5, 97.5), axis=0)
for joint, color in ((0, "C0"), (4, "C1"), (8, "C2")):
    angle = np.degrees(shown.joint_angle[:, joint])
    curves.plot(shown.time, angle, color=color, label=f"joint {joint + 1}")
    band = low[:, joint], high[:, joint]
    curves.fill_between(shown.time, *band, color=color, alpha=0.25, linewidth=0)
    true = np.degrees(swim.joint_angle[filmed, joint])
    curves.plot(swim.time[filmed], true, "k:", linewidth=1)
curves.set_xlim(*forces.window.time[[0, -1]])
curves.set_xlabel("time [s]")
curves.set_ylabel("joint angle [deg]")
curves.set_title("fit with its 95 % band; dotted: true", fontsize="medium")
curves.legend(
    loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=3, frameon=False
)
links = forces.link_figures
median = np.array([one.median for one in links])
reach = np.array([[one.median - one.low, one.high - one.median] for one in links]).T
bars.bar(np.arange(1, 11), 1e3 * median, yerr=1e3 * reach, color="C0")
bars.axhline(0.0, color="gray", linewidth=0.8)
bars.set_xlabel("link, from the tail")
bars.set_ylabel("mean force along the way [mN]")
bars.set_title("thrust above 0, drag below; 95 % intervals", fontsize="medium")
figure.savefig("film_to_forces.png", dpi=150)
