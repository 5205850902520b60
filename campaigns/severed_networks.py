"""How fast a robot with a severed cord swims: 20 random networks, without and with feedback of what the body feels.

    python campaigns/severed_networks.py           # run, print, and compare with the stored table
    python campaigns/severed_networks.py --write   # run and store severed_networks.csv

Every network has random initial phases and natural frequencies. Mamba swims by Ekeberg's muscles;
the coupling between all of its oscillators is cut. Published for a robot of ten modules: R.
Thandiackal et al., Science Robotics 6, 2021.
"""

import argparse
import csv
import warnings
from pathlib import Path

import numpy as np

import laticauda as lc
from laticauda.control import Feedback, PhaseOscillators

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


def swim(seed: int, feedback: Feedback, cuts: tuple[int, ...]) -> float:
    """Return the speed of one network, in whatever direction it goes [m/s].

    Args:
        seed: Seed of the network.
        feedback: What its oscillators feel.
        cuts: Joints whose coupling is severed.
    """
    network = PhaseOscillators(gait=GAIT, feedback=feedback, cuts=cuts, seed=seed, spread=SPREAD)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        trial = lc.swim("mamba", network, DURATION, joints="ekeberg")
    half = len(trial.time) // 2
    way = trial.center_of_mass[-1] - trial.center_of_mass[half]
    return float(np.linalg.norm(way) / (trial.time[-1] - trial.time[half]))


def run(seed: int) -> dict[str, float]:
    """Return the speeds of one network: intact, severed, and severed with feedback [m/s].

    Args:
        seed: Seed of the network.
    """
    return {
        "seed": seed,
        "intact": swim(seed, Feedback(), ()),
        "severed": swim(seed, Feedback(), ALL_JOINTS),
        "severed_with_feedback": swim(seed, FEEDBACK, ALL_JOINTS),
    }


def summarize(rows: list[dict[str, float]]) -> str:
    """Return what the table says in three lines.

    Args:
        rows: One row per network.
    """
    lines: list[str] = []
    for column in ("severed", "severed_with_feedback"):
        shares = np.array([row[column] / row["intact"] for row in rows])
        lines.append(
            f"{column}: median {np.median(shares):.2f} of the intact speed, "
            f"from {shares.min():.2f} to {shares.max():.2f}; "
            f"below 0.10 in {np.sum(shares < 0.1)}, above 0.50 in {np.sum(shares > 0.5)} of {len(rows)}"
        )
    return "\n".join(lines)


def read_table() -> list[dict[str, float]]:
    """Return the stored rows."""
    with TABLE.open() as file:
        return [{name: float(text) for name, text in row.items()} for row in csv.DictReader(file)]


def main() -> None:
    """Run all networks, and store or compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    rows: list[dict[str, float]] = []
    for seed in SEEDS:
        row = run(seed)
        rows.append(row)
        print({name: round(number, 4) for name, number in row.items()}, flush=True)
    print(summarize(rows))
    if arguments.write:
        with TABLE.open("w", newline="") as file:
            writer = csv.DictWriter(file, fieldnames=list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(
                {name: f"{number:.6g}" for name, number in row.items()} for row in rows
            )
    else:
        for row, stored in zip(rows, read_table(), strict=True):
            for name, number in stored.items():
                if abs(row[name] - number) > 1e-3:
                    raise SystemExit(
                        f"network {row['seed']}: {name} is {row[name]}, stored {number}"
                    )


if __name__ == "__main__":
    main()
