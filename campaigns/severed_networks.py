"""How fast a robot with a severed cord swims: 20 random networks, without and with feedback of what the body feels.

    python campaigns/severed_networks.py           # run, print, and compare with the stored table
    python campaigns/severed_networks.py --write   # run and store severed_networks.csv

Every network has random initial phases and natural frequencies. Mamba swims by Ekeberg's muscles;
the coupling between all of its oscillators is cut. All networks swim side by side, in
a few seconds. Published for a robot of ten modules: R. Thandiackal et al., Science Robotics 6, 2021.
"""

import argparse
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from _rows import append_row, stored

import laticauda as lc
from laticauda.control import Feedback, PhaseOscillators
from laticauda.models.simulate import swim_side_by_side

TABLE = Path(__file__).with_suffix(".csv")
SEEDS = range(20)
DURATION = 90.0
"""Duration of a run; the speed is that over its second half [s]."""
SPREAD = 0.05
"""Standard deviation of the natural frequencies, per frequency [-]."""
FEEDBACK = Feedback(pressure=0.08, stretch=-3.0)
"""Gains found by trying a few on the networks 0 to 5 [1/(Pa s), 1/(rad s)]."""
GAIT = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40)
ALL_JOINTS = tuple(range(7))


def swim(seeds: Sequence[int], feedback: Feedback, cuts: tuple[int, ...]) -> list[float]:
    """Return the speed of every network, in whatever direction it goes [m/s].

    Args:
        seeds: Seeds of the networks.
        feedback: What their oscillators feel.
        cuts: Joints whose coupling is severed.
    """
    network = PhaseOscillators(gait=GAIT, feedback=feedback, cuts=cuts, spread=SPREAD)
    scenario = lc.build_scenario("mamba", network, DURATION, joints="ekeberg")
    scenarios = [replace(scenario, motion=replace(network, seed=seed)) for seed in seeds]
    return [speed_of(trial) for trial in swim_side_by_side(scenarios)]


def speed_of(trial: lc.Trial) -> float:
    """Return the speed over the second half of a trial, in whatever direction it goes [m/s].

    Args:
        trial: The trial.
    """
    half = len(trial.time) // 2
    way = trial.center_of_mass[-1] - trial.center_of_mass[half]
    return float(np.linalg.norm(way) / (trial.time[-1] - trial.time[half]))


@dataclass(frozen=True)
class Network:
    """Speeds of one network [m/s]."""

    seed: int
    intact: float
    severed: float
    severed_with_feedback: float


def run(seeds: Sequence[int]) -> list[Network]:
    """Return the speeds of every network: intact, severed, and severed with feedback.

    Args:
        seeds: Seeds of the networks.
    """
    speeds = zip(
        seeds,
        swim(seeds, Feedback(), ()),
        swim(seeds, Feedback(), ALL_JOINTS),
        swim(seeds, FEEDBACK, ALL_JOINTS),
        strict=True,
    )
    return [Network(*of_network) for of_network in speeds]


def shares_of(networks: list[Network], column: str) -> np.ndarray:
    """Return the speed of every network in one state, per that of the intact one [-].

    Args:
        networks: The networks.
        column: The state: `severed` or `severed_with_feedback`.
    """
    return np.array([getattr(network, column) / network.intact for network in networks])


def summarize(networks: list[Network]) -> str:
    """Return what the table says in two lines.

    Args:
        networks: The networks.
    """
    lines: list[str] = []
    for column in ("severed", "severed_with_feedback"):
        shares = shares_of(networks, column)
        lines.append(
            f"{column}: median {np.median(shares):.2f} of the intact speed, "
            f"from {shares.min():.2f} to {shares.max():.2f}; "
            f"below 0.10 in {np.sum(shares < 0.1)}, above 0.50 in {np.sum(shares > 0.5)} of {len(networks)}"
        )
    return "\n".join(lines)


def read_table() -> list[Network]:
    """Return the stored networks."""
    return stored(TABLE, Network)


def main() -> None:
    """Run all networks, and store or compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    networks = run(SEEDS)
    print(*networks, sep="\n")
    print(summarize(networks))
    if arguments.write:
        TABLE.unlink(missing_ok=True)
        for network in networks:
            append_row(TABLE, network)
        return
    for network, stored_network in zip(networks, read_table(), strict=True):
        for name, number in asdict(stored_network).items():
            if abs(getattr(network, name) - number) > 1e-3:
                raise SystemExit(f"{network}: {name} is stored as {number}")


if __name__ == "__main__":
    main()
