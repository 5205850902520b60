"""How often does a robot inspect a net and dock, by its sensors alone?

Question: `net-inspection` with 1 000 seeds: current from 0 to half of the top speed (0.22 m/s) from any direction,
waves up to 0.1 m high, a start that is off by 0.15 m and 10 deg, 5 % of all measurements lost, and one sensor
that is silent or frozen for 10 to 40 s. Does it dock, without contact with the net, and see the net?

    python campaigns/missions.py             # the table, from missions.csv
    python campaigns/missions.py --run       # the runs that the file has not yet

The table: 1 000 seeds, 1 000 docked (95 % interval of Wilson 99.6 to 100.0 %), 0 contacts, least clearance 0.54 m,
at least 90 % of the net seen in 1 000.
"""

import argparse
from dataclasses import asdict
from pathlib import Path

from laticauda.missions import load_mission
from laticauda.missions.campaign import Conditions, run_campaign, summarize_campaign
from laticauda.missions.campaign_table import read_rows

STORED = Path(__file__).with_suffix(".csv")
N_SEEDS = 1000
FAILING = ("sonar", "compass", "inertial", "velocity", "water_velocity", "beacon")
CONDITIONS = Conditions(failing=FAILING)


def main() -> None:
    """Go on with the campaign if asked, and print its table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--run", action="store_true", help="run what is not yet in the file")
    parser.add_argument("--seeds", type=int, nargs=2, default=(0, N_SEEDS), help="first and end")
    parser.add_argument("--file", type=Path, default=STORED)
    parser.add_argument("--at-once", type=int, default=16)
    chosen = parser.parse_args()
    if chosen.run:
        mission = load_mission("net-inspection")
        seeds = range(*chosen.seeds)
        run_campaign(mission, CONDITIONS, seeds, chosen.file, at_once=chosen.at_once)
    for name, value in asdict(summarize_campaign(read_rows(chosen.file))).items():
        print(f"{name:20} {value}")


if __name__ == "__main__":
    main()
