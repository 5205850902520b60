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

distances, gains = (
    (0.09, 0.18, 0.36, 0.54, 0.9, 1.62, 3.24, 4.24),
    (0.1, 0.2, 0.3, 0.4, 0.6, 0.8),
)
lateral = (
    lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=90, phase_shift_deg=40),
    "paper-lateral",
)
eel = (
    lc.eel_like(amplitude_deg=40, frequency_deg_s=90, phase_shift_deg=40),
    "paper-eel",
)
swimmers = [
    (robot, *how) for how in (lateral, eel) for robot in ("mamba", "mamba-fin")
]
swimmers = swimmers if "all" in sys.argv else swimmers[:1]
figure, panels = new_panels(
    len(swimmers), width=1.5 + 3.0 * len(swimmers), height=3.8
)


def errors(plant, gait, distance, gain, heading_estimate):
    """Rms of the cycle-mean error over the last third, and the third before [m]."""
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
    return following.steady_error(*error, 80.0), following.steady_error(
        *error, 40.0, 80.0
    )


for (robot, gait, water), ax in zip(swimmers, panels, strict=True):
    name, plant = (
        f"{gait.words}, {robot}",
        lc.build_plant(lc.load_robot(robot), lc.load_water(water)),
    )
    found = np.array(
        [
            [errors(plant, gait, far, gain, "cycle_mean") for gain in gains]
            for far in distances
        ]
    )
    rms, before = found[..., 0], found[..., 1]
    # neither settled nor still approaching
    swings = (rms >= 0.05) & (rms**2 > 0.5 * before**2)
    first = np.flatnonzero(swings[:, 3])[-1] + 1
    raw, _ = errors(plant, gait, 0.18, 0.4, "raw")
    print(
        f"{name}: at gain 0.4 it settles from {distances[first]} m on; "
        f"{swings.sum()} of {swings.size} loops swing on"
    )
    print(
        f"  the paper's gains: {100 * rms[1, 3]:.1f} cm rms, with the raw heading "
        f"{100 * raw:.1f} cm"
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
    paper = gains.index(0.4), distances.index(0.18)
    ax.plot(*paper, **style.marker_style("o", 7.0, "white"))
    style.add_note(ax, "the paper's gains", paper, (6, 4), color="white")
    ax.set_title(name, fontsize=style.LABEL, loc="left")
    style.style_axes(ax, xlabel="gain [-]", ylabel="look-ahead distance [m]")
bar = figure.colorbar(image, ax=panels)
bar.set_label("rms error in the last third [cm]", fontsize=style.LABEL)
bar.ax.tick_params(labelsize=style.TICK)
save_figure(figure, "how-far-ahead.png")
