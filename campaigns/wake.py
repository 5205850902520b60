"""A swimmer in the wake of another one: how much faster or slower it is, and what a meter costs, by place and phase.

Question: two equal fish robots (`tendon-fish`, with the first harmonic of its joints in a published
video) swim one behind the other. The follower swims freely in the prescribed street of the leader, in line or beside
its way, at several distances and phases. What are its speed and its cost of transport, against swimming
alone? Does the best phase lag grow linearly with the distance, as it does for robots of that
size (Li et al., Nature Communications 11:5408, 2020), and is it worse to swim behind than beside (Weihs 1973)?

    python campaigns/wake.py             # the table, from wake.csv
    python campaigns/wake.py --run       # all runs anew, some minutes of one core; writes wake.csv
    python campaigns/wake.py --figure docs/images/wake.png

Runs begin straight, at the leader's speed; figures are those of two cycles after the first two. The
distance is that from tail to tail, the mean over these cycles; the phase that of the follower's tail less that of the
leader's.
"""

import argparse
import math
import warnings
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import tendon_fish
from _rows import append_row, stored
from matplotlib.axes import Axes

import laticauda as lc
from laticauda.robot import Posture
from laticauda.show.figures import save_figure, style
from laticauda.trials import measure_wake
from laticauda.water.fluid import Wake

TABLE = Path(__file__).with_suffix(".csv")
VIDEO = 3
"""Row of the fish's table: 0.94 Hz."""
BESIDE = (0.0, 0.15, 0.25)
"""How far the follower starts to the left of the leader's way [m]: 0, 0.3 and 0.5 body lengths."""
GAPS = tuple(0.05 * k for k in range(1, 13))
"""Distances from the leader's tail to the follower's head at the start [m]."""
N_PHASES = 12
SETTLING = 2
"""Cycles before the figures begin."""
MEASURED = 2
"""Cycles over which the figures are taken."""
SAMPLES = 24
"""Samples in a cycle."""
STEPS = 100
"""Time steps in a cycle."""
LEADER_CYCLES = 30


@dataclass(frozen=True)
class Row:
    """A follower at one place and phase."""

    beside: float
    """How far it starts to the left of the leader's way [m]."""
    gap: float
    """Distance from the leader's tail to its head at the start [m]."""
    leader_phase: float
    """Phase of the leader's tail at the start [rad]."""
    distance: float
    """Mean distance from the leader's tail to its tail, along the way [m]."""
    phase: float
    """Phase of its tail less that of the leader's, -pi to pi [rad]."""
    left: float
    """Mean distance of its center of mass to the left of the leader's way [m]."""
    speed: float
    """Speed over that alone, minus 1 [-]."""
    cost: float
    """Cost of transport over that alone, minus 1 [-]."""

    @property
    def power(self) -> float:
        """Mechanical power over that alone, minus 1 [-]."""
        return (1.0 + self.cost) * (1.0 + self.speed) - 1.0


@dataclass(frozen=True)
class Measured:
    """Figures of the measured cycles of a run."""

    speed: float
    """Along the leader's way [m/s]."""
    power: float
    """Mechanical [W]."""
    tail: float
    """Mean x of the tail [m]."""
    time: float
    """Mean time [s]."""
    left: float
    """Mean y of the center of mass [m]."""
    phase: float
    """Phase of the tail's beat at time 0 [rad]."""

    def __str__(self) -> str:
        """Return speed and power in words."""
        return f"{self.speed:.3f} m/s, {self.power:.3f} W"


@dataclass(frozen=True)
class Fit:
    """Speed or cost of followers as a wave of phase and distance: mean + depth cos(phase + k distance - best)."""

    mean: float
    """Mean [-]."""
    depth: float
    """Amplitude [-]."""
    best: float
    """Phase at which it is largest, at distance 0 [rad]."""
    wave_number: float
    """k [1/m]."""
    explained: float
    """Share of the variance that it explains [-]."""

    def __str__(self) -> str:
        """Return it in words."""
        length = 2.0 * math.pi / self.wave_number
        return (
            f"{100.0 * self.mean:+.1f} % on average, {100.0 * self.depth:.1f} % more at "
            f"{math.degrees(self.best):.0f} deg, once around in {length:.3f} m, "
            f"{100.0 * self.explained:.0f} % of the variance"
        )


@cache
def swim_of_video() -> tendon_fish.Swim:
    """Return what the video says."""
    return tendon_fish.swims()[VIDEO]


@cache
def gait() -> lc.Gait:
    """Return the gait with the amplitude and phase of every joint."""
    joints = np.array(swim_of_video().joints)
    amplitudes = np.abs(joints)
    largest = float(amplitudes.max())
    leads = np.angle(joints * 1j)
    return lc.Gait(
        amplitude=largest,
        frequency=2.0 * math.pi * swim_of_video().frequency,
        phase_shift=0.0,
        envelope=lc.Custom(values=tuple((amplitudes / largest).tolist())),
        phases=tuple(leads.tolist()),
    )


def period() -> float:
    """Return the period of the gait [s]."""
    return 1.0 / swim_of_video().frequency


def water() -> lc.Water:
    """Return the textbook's water for the fish."""
    return tendon_fish.textbook(swim_of_video())


def swim(environment: lc.Water, n_cycles: int, start: lc.Start) -> lc.Trial:
    """Return a run of the fish.

    Args:
        environment: Water in which it swims.
        n_cycles: Duration in cycles.
        start: Start of the run.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return lc.swim(
            "tendon-fish",
            gait(),
            n_cycles * period(),
            environment=environment,
            start=start,
            dt=period() / STEPS,
            sample_interval=period() / SAMPLES,
        )


@cache
def leader_wake() -> Wake:
    """Return the wake of the leader, which swims along x."""
    return measure_wake(swim(water(), LEADER_CYCLES, lc.Start()))


@cache
def start() -> lc.Start:
    """Return the start of a follower: straight, at the leader's speed, so that alone it swims along x."""
    return lc.Start(heading=-leader_wake().direction, velocity=leader_wake().speed)


@cache
def straight() -> np.ndarray:
    """Return x of the trailing edge and of the nose of the straight fish about its center of mass [m]."""
    robot = lc.load_robot("tendon-fish")
    posture = Posture(robot, np.zeros(2), np.zeros(robot.n_links))
    return np.array([posture.trailing_edge[0], posture.link_ends[-1, 0]])


def measure(trial: lc.Trial) -> Measured:
    """Return the figures of the measured cycles of a run.

    Args:
        trial: The run.
    """
    first = SETTLING * SAMPLES
    time = trial.time[first:]
    center = trial.center_of_mass[first:]
    duration = time[-1] - time[0]
    posture = Posture(
        trial.chain, center, trial.link_angle[first:], fin_angle=trial.fin_angle[first:]
    )
    tail = posture.trailing_edge
    turns = 2.0 * math.pi * time / period()
    terms = np.stack([np.ones_like(time), time, np.cos(turns), np.sin(turns)], axis=1)
    (_, _, cosine, sine), *_ = np.linalg.lstsq(terms, tail[:, 1], rcond=None)
    return Measured(
        speed=float((center[-1, 0] - center[0, 0]) / duration),
        power=float((trial.work[-1, 0] - trial.work[first, 0]) / duration),
        tail=float(np.mean(tail[:, 0])),
        time=float(np.mean(time)),
        left=float(np.mean(center[:, 1])),
        phase=math.atan2(cosine, sine),
    )


@cache
def alone() -> Measured:
    """Return the figures of the fish that swims alone."""
    return measure(swim(water(), SETTLING + MEASURED, start()))


def wake_ahead(beside: float, gap: float, leader_phase: float) -> Wake:
    """Return the wake of a leader ahead of a fish at the origin.

    Args:
        beside: How far the fish is to the left of the leader's way [m].
        gap: Distance from the leader's tail to the nose of the fish [m].
        leader_phase: Phase of the leader's tail at the start [rad].
    """
    nose = float(straight()[1])
    # A fish that starts straight drifts a little to the left before the measured cycles.
    way = alone().left - beside
    return replace(leader_wake(), direction=0.0, x=nose + gap, y=way, phase=leader_phase)


def follow(beside: float, gap: float, leader_phase: float) -> Row:
    """Return the figures of a follower.

    Args:
        beside: How far it starts to the left of the leader's way [m].
        gap: Distance from the leader's tail to its nose at the start [m].
        leader_phase: Phase of the leader's tail at the start [rad].
    """
    wake = wake_ahead(beside, gap, leader_phase)
    figures = measure(swim(replace(water(), current=wake), SETTLING + MEASURED, start()))
    speed = figures.speed / alone().speed
    power = figures.power / alone().power
    lag = alone().phase - leader_phase
    return Row(
        beside=beside,
        gap=gap,
        leader_phase=leader_phase,
        distance=wake.x + wake.speed * figures.time - figures.tail,
        phase=math.atan2(math.sin(lag), math.cos(lag)),
        left=figures.left - wake.y,
        speed=speed - 1.0,
        cost=power / speed - 1.0,
    )


def compare_models() -> float:
    """Return how far apart Mambas of both models are after 3 s in a wake, per distance that the wake moved one [-]."""
    wave = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=120, phase_shift_deg=40)
    scenario = lc.build_scenario("mamba", wave, 3.0, current="wake")
    space = lc.build_scenario("mamba", wave, 3.0, current="wake", model="spatial", root="planar")
    alone_in_plane = lc.build_scenario("mamba", wave, 3.0)
    scenarios = (scenario, space, alone_in_plane)
    ends = [lc.swim(scenario).center_of_mass[-1, :2] for scenario in scenarios]
    difference_of_models, effect_of_wake = np.linalg.norm(ends[1:] - ends[0], axis=1).tolist()
    return difference_of_models / effect_of_wake


def places() -> Iterable[tuple[float, float, float]]:
    """Yield the places and phases of all followers."""
    for beside in BESIDE:
        for gap in GAPS:
            for k in range(N_PHASES):
                yield beside, gap, 2.0 * math.pi * k / N_PHASES


def fit_wave(rows: list[Row], name: str, wave_number: float | None = None) -> Fit:
    """Return the wave of phase and distance that fits best.

    Args:
        rows: Followers.
        name: `speed` or `cost`.
        wave_number: Wave number [1/m]; None: the best of many.
    """
    values = np.array([getattr(row, name) for row in rows])
    phases = np.array([row.phase for row in rows])
    distances = np.array([row.distance for row in rows])
    wave_numbers = [wave_number]
    if wave_number is None:
        wave_numbers = np.linspace(0.0, 60.0, 1201).tolist()
    best: Fit | None = None
    for k in wave_numbers:
        turns = phases + k * distances
        terms = np.stack([np.ones_like(turns), np.cos(turns), np.sin(turns)], axis=1)
        (mean, cosine, sine), *_ = np.linalg.lstsq(terms, values, rcond=None)
        left_over = values - terms @ np.array([mean, cosine, sine])
        explained = 1.0 - float(np.var(left_over) / np.var(values))
        if best is None or explained > best.explained:
            depth = math.hypot(cosine, sine)
            phase = math.atan2(sine, cosine)
            best = Fit(float(mean), depth, phase, k, explained)
    assert best is not None
    return best


def tabulate(rows: list[Row]) -> str:
    """Return the table of the page.

    Args:
        rows: All followers.
    """
    lines = [
        "| beside [m] | speed [%] | power [%] | cost of transport [%] | wave length of the power [m] | explained [%] |",
        "|---|---|---|---|---|---|",
    ]
    for beside in BESIDE:
        followers = [row for row in rows if row.beside == beside]
        fit = fit_wave(followers, "power")
        cells = [f"{beside:.2f}"]
        cells += [describe_range(followers, name) for name in ("speed", "power", "cost")]
        cells += [f"{2.0 * math.pi / fit.wave_number:.3f}", f"{100.0 * fit.explained:.0f}"]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def describe_range(rows: list[Row], name: str) -> str:
    """Return the mean of a figure, and the lowest and the highest value, in percent.

    Args:
        rows: Followers.
        name: Name of the figure.
    """
    values = 100.0 * np.array([getattr(row, name) for row in rows])
    return f"{values.mean():+.1f} ({values.min():+.1f} to {values.max():+.1f})"


def draw(rows: list[Row], path: str) -> None:
    """Draw a follower in the street, and maps of the followers' figures by distance and phase.

    Args:
        rows: All followers.
        path: File of the picture.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, 4.9)
    grid = figure.add_gridspec(2, 3, height_ratios=(1.0, 1.5))
    draw_street(figure.add_subplot(grid[0, :]))
    maps = (
        ("in line: power", 0.0, "power"),
        ("in line: speed", 0.0, "speed"),
        ("0.25 m beside: speed", 0.25, "speed"),
    )
    for panel, (title, beside, name) in enumerate(maps):
        ax = figure.add_subplot(grid[1, panel])
        draw_map(ax, [row for row in rows if row.beside == beside], name)
        style.add_letter(ax, panel + 1, title)
        ylabel = "lead over the leader's beat [deg]" if panel == 0 else ""
        style.style_axes(ax, xlabel="distance from tail to tail [m]", ylabel=ylabel)
    save_figure(figure, path)


def draw_street(ax: Axes) -> None:
    """Draw two fish and the velocity of the water between them, 3 cycles after the start of a run in line.

    Args:
        ax: Axes to draw in.
    """
    wake = wake_ahead(0.0, 0.3, 0.0)
    trial = swim(replace(water(), current=wake), SETTLING + MEASURED, start())
    sample = 3 * SAMPLES
    time = trial.time[sample]
    follower = Posture(trial.chain, trial.center_of_mass[sample], trial.link_angle[sample])
    x, y = np.meshgrid(np.linspace(0.1, 2.1, 401), np.linspace(-0.28, 0.28, 113))
    turning = wake.felt(x, y, 0.0, time).s_z
    largest = float(np.max(np.abs(turning)))
    ax.pcolormesh(x, y, turning, cmap="RdBu_r", vmin=-largest, vmax=largest, rasterized=True)
    some = slice(6, None, 12), slice(6, None, 12)
    water_there = wake.motion(x[some], y[some], 0.0, time)
    ax.quiver(
        x[some], y[some], water_there.u, water_there.v, color=style.INK, scale=4.0, width=0.0015
    )
    for body in (follower, leader_posture(wake, time)):
        line = np.concatenate([body.fin_line[:-1], body.link_ends])
        ax.plot(line[:, 0], line[:, 1], color=style.INK, linewidth=2.5, solid_capstyle="round")
    ax.set_aspect("equal")
    style.add_letter(ax, 0, "a follower in line; blue water turns clockwise, red counter-clockwise")
    style.style_axes(ax, xlabel="x [m]", ylabel="y [m]")


def leader_posture(wake: Wake, time: float) -> Posture:
    """Return the leader's posture at a time, its tail where the wake says.

    Args:
        wake: The wake.
        time: Time since the start of the run [s].
    """
    trial = swim(water(), SETTLING + MEASURED, start())
    turns = wake.phase - alone().phase + 2.0 * math.pi * time / period()
    cycle = turns / (2.0 * math.pi) % 1.0
    sample = SAMPLES * (SETTLING + MEASURED - 1) + round(SAMPLES * cycle)
    angle = trial.link_angle[sample]
    at_origin = Posture(trial.chain, np.zeros(2), angle)
    beat = 0.5 * wake.width * math.sin(2.0 * math.pi * time / period() + wake.phase)
    tail = np.array([wake.x + wake.speed * time, wake.y + beat])
    return Posture(trial.chain, tail - at_origin.trailing_edge, angle)


def draw_map(ax: Axes, rows: list[Row], name: str) -> None:
    """Draw a figure of followers by distance and phase, with the line along which its wave is lowest or highest.

    Args:
        ax: Axes to draw in.
        rows: Followers.
        name: Name of the figure.
    """
    distance = np.array([row.distance for row in rows])
    phase = np.degrees([row.phase for row in rows])
    value = 100.0 * np.array([getattr(row, name) for row in rows])
    # The phase goes round: what is at 190 deg is at -170 deg, too.
    distances = np.concatenate([distance] * 3)
    phases = np.concatenate([phase - 360.0, phase, phase + 360.0])
    filled = ax.tricontourf(
        distances, phases, np.concatenate([value] * 3), levels=12, cmap="viridis"
    )
    bar = ax.figure.colorbar(filled, ax=ax, orientation="horizontal", pad=0.03)
    bar.set_label(f"{name} against alone [%]", fontsize=style.TICK)
    bar.ax.tick_params(labelsize=style.TICK)
    fit = fit_wave(rows, name)
    best = fit.best
    if name == "power":
        best += math.pi
    nearest, furthest = np.percentile(distance, [8.0, 92.0])
    along = np.linspace(nearest, furthest, 200)
    for turn in range(-4, 8):
        line = np.degrees(best - fit.wave_number * along) + 360.0 * turn
        ax.plot(along, line, color="white", linestyle="--", linewidth=1.0)
    ax.set_xlim(nearest, furthest)
    ax.set_ylim(-180.0, 180.0)
    ax.set_yticks([-180, -90, 0, 90, 180])


def read_table() -> list[Row]:
    """Return the stored followers."""
    return stored(TABLE, Row)


def main() -> None:
    """Run all followers, or show the stored ones."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--run", action="store_true")
    parser.add_argument("--figure")
    arguments = parser.parse_args()
    if arguments.run:
        TABLE.unlink(missing_ok=True)
        for place in places():
            append_row(TABLE, follow(*place))
        print(f"plane and space differ by {compare_models():.1g} of what the wake changes")
    rows = read_table()
    wake = leader_wake()
    print(wake.words)
    print(f"spacing {wake.spacing:.3f} m, drift {wake.drift:.4f} m/s, jet {wake.jet:.4f} m/s")
    print(f"alone: {alone()}")
    print(tabulate(rows))
    for beside in BESIDE:
        followers = [row for row in rows if row.beside == beside]
        for name in ("speed", "power", "cost"):
            print(f"{beside:g} m beside, {name}: {fit_wave(followers, name)}")
    if arguments.figure:
        draw(rows, arguments.figure)


if __name__ == "__main__":
    main()
