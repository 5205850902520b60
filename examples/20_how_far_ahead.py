"""How far ahead must line of sight look? A map over look-ahead distance and gain
shows where the loop settles on the path.

The mean heading over the gait cycle is free of the gait's ripple but half a period
late: with the paper's distance of 0.18 m and gain of 0.4, the robot oscillates
about the path. At that gain, it settles from 0.36 m on; two robot lengths, the rule
of thumb, are sufficient but not necessary. The other three swimmers of the paper
run too with `python examples/20_how_far_ahead.py all`.
"""

import sys
from math import radians

import numpy as np

import laticauda as lc
from laticauda.show.figures import new_panels, save_figure, style
from laticauda.trials import following

distances = (0.09, 0.18, 0.36, 0.54, 0.9, 1.62, 3.24, 4.24)  # [m]
gains = (0.1, 0.2, 0.3, 0.4, 0.6, 0.8)
lateral = lc.lateral_undulation(
    amplitude_deg=30, frequency_deg_s=90, phase_shift_deg=40
)
eel = lc.eel_like(amplitude_deg=40, frequency_deg_s=90, phase_shift_deg=40)
swimmers = [
    ("mamba", lateral, "paper-lateral"),
    ("mamba-fin", lateral, "paper-lateral"),
    ("mamba", eel, "paper-eel"),
    ("mamba-fin", eel, "paper-eel"),
]
if "all" not in sys.argv:
    swimmers = swimmers[:1]
figure, panels = new_panels(
    len(swimmers), width=1.5 + 3.0 * len(swimmers), height=3.8
)


def errors(plant, gait, distance, gain, heading_estimate):
    """Return the rms error over the last third, and over the one before [m]."""
    controller = lc.PathFollowing(
        gait=gait,
        path=lc.StraightLine(),
        guidance=lc.LineOfSight(look_ahead_distance=distance),
        heading=lc.HeadingController(gain=gain, max_offset=radians(20)),
        heading_estimate=heading_estimate,
        interval=0.2,
    )
    trial = lc.run(
        plant,
        controller,
        120.0,
        start=lc.Start(center_of_mass=(0.0, 0.5)),
        sample_interval=0.2,
    )
    error = trial.time, trial.signals["cross_track_error"], trial.period
    last = following.steady_error(*error, 80.0)
    before = following.steady_error(*error, 40.0, 80.0)
    return last, before


for (robot, gait, water), ax in zip(swimmers, panels, strict=True):
    name = f"{gait.words}, {robot}"
    plant = lc.build_plant(lc.load_robot(robot), lc.load_water(water))
    rms = np.zeros((len(distances), len(gains)))
    before = np.zeros(rms.shape)
    for i, j in np.ndindex(rms.shape):
        rms[i, j], before[i, j] = errors(
            plant, gait, distances[i], gains[j], "cycle_mean"
        )
    is_settled = rms < 0.05
    is_approaching = rms**2 <= 0.5 * before**2
    swings = ~is_settled & ~is_approaching
    gain, distance = gains.index(0.4), distances.index(0.18)  # those of the paper
    first = np.flatnonzero(swings[:, gain])[-1] + 1
    raw, _ = errors(plant, gait, 0.18, 0.4, "raw")
    print(
        f"{name}: at gain 0.4 it settles from {distances[first]} m on; "
        f"{swings.sum()} of {swings.size} loops swing on"
    )
    print(
        f"  the paper's gains: {100 * rms[distance, gain]:.1f} cm rms, "
        f"with the raw heading {100 * raw:.1f} cm"
    )
    image = ax.imshow(
        100 * rms,
        origin="lower",
        aspect="auto",
        cmap="cividis",
        norm="log",
        vmin=0.1,
        vmax=40,
    )
    ax.set_xticks(range(len(gains)), gains)
    ax.set_yticks(range(len(distances)), distances)
    ax.plot(gain, distance, **style.marker_style("o", 7.0, "white"))
    marker = (gain, distance)
    style.add_note(ax, "the paper's gains", marker, (6, 4), color="white")
    ax.set_title(name, fontsize=style.LABEL, loc="left")
    style.style_axes(ax, xlabel="gain [-]", ylabel="look-ahead distance [m]")
bar = figure.colorbar(image, ax=panels)
bar.set_label("rms error in the last third [cm]", fontsize=style.LABEL)
bar.ax.tick_params(labelsize=style.TICK)
save_figure(figure, "how-far-ahead.png")
