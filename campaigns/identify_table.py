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
    name_of_kind = {kind: name for name, kind in KINDS.items()}
    lines = [HEAD]
    for row in read_efficiency_trials():
        gait = row.gait
        cells = [name_of_kind[gait.kind], "fin" if row.has_fin else "nofin"]
        for angle in (gait.amplitude, gait.frequency, gait.phase_shift):
            cells.append(f"{degrees(angle):.0f}")
        for number in (row.forward_velocity, row.mean_power):
            cells.append("" if number is None else str(number))
        lines.append(",".join(cells))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main() -> None:
    table = tomllib.loads(EXAMPLE.read_text(encoding="utf-8"))
    del table["table1"]
    table["table"] = {"file": "table1.csv", "sigma": 0.05}
    with TemporaryDirectory() as folder:
        write_table1(Path(folder) / "table1.csv")
        task_of_file = task_from_table(table, "mine", Path(folder))
    for title, task in (("a file", task_of_file), ("the paper's rows", load_task(EXAMPLE))):
        result = task.run()
        print(f"{title}: {result.percentage_error():.2f} %", flush=True)
        for estimate in result.estimates:
            print(f"  {estimate.name:28} {estimate.value!r} +- {estimate.sigma:.2g}", flush=True)


if __name__ == "__main__":
    main()
