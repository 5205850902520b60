"""Does a table of speeds give the numbers of the preset that was fitted to them?

Question: the paper's Table 1 as a CSV file of one's own, one row a trial, in the place of
`[table1]` in examples/mamba-identified.toml. Are the two numbers those that the preset prints, and
those of the paper's own rows to the last digit?

    python campaigns/identify_table.py

Last answer (2 shared cores, 2026-11-22, 2 minutes):
a file: 4.99 %
  water.tangential_friction    0.27255029035895884 +- 0.018
  joints.speed_limit           0.7046257360827245 +- 0.044
the paper's rows: 4.99 %
  water.tangential_friction    0.27255029035895884 +- 0.018
  joints.speed_limit           0.7046257360827245 +- 0.044

The preset prints 0.2726 and 0.7046 rad/s.
"""

import tomllib
from math import degrees
from pathlib import Path
from tempfile import TemporaryDirectory

from laticauda.identify.tasks import load_task, task_from_table
from laticauda.paper.measured import read_efficiency_trials
from laticauda.trials.measured import KINDS

EXAMPLE = Path(__file__).parents[1] / "examples" / "mamba-identified.toml"
HEAD = "gait,config,alpha_deg,omega_deg_s,delta_deg,v_m_s,P_avg_W"


def write_table1(path: Path) -> None:
    """Table 1 as a file of one's own."""
    short = {kind: name for name, kind in KINDS.items()}
    lines = [HEAD]
    for row in read_efficiency_trials():
        gait = row.gait
        angles = (
            f"{degrees(one):.0f}" for one in (gait.amplitude, gait.frequency, gait.phase_shift)
        )
        cells = (
            short[gait.kind],
            "fin" if row.has_fin else "nofin",
            *angles,
            row.forward_velocity,
            row.mean_power,
        )
        lines.append(",".join("" if cell is None else str(cell) for cell in cells))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main() -> None:
    told = tomllib.loads(EXAMPLE.read_text(encoding="utf-8"))
    own = {name: one for name, one in told.items() if name != "table1"}
    with TemporaryDirectory() as folder:
        write_table1(Path(folder) / "table1.csv")
        mine = task_from_table(
            {**own, "table": {"file": "table1.csv", "sigma": 0.05}}, "mine", Path(folder)
        )
    for title, task in (("a file", mine), ("the paper's rows", load_task(EXAMPLE))):
        found = task.run()
        print(f"{title}: {found.percentage_error():.2f} %", flush=True)
        for one in found.estimates:
            print(f"  {one.name:28} {one.value!r} +- {one.sigma:.2g}", flush=True)


if __name__ == "__main__":
    main()
