"""Table 1 of the paper, simulated with the paper's own coefficients and compared
with the measurements on the robot.

`run_efficiency` repeats the whole study; this example runs only the table.
`laticauda reproduce` runs all of it, draws the figures and writes a report.

    python examples/04_reproduce_table1.py
"""

from dataclasses import replace
from math import degrees

import matplotlib.pyplot as plt

from laticauda.paper import find_fin_gains, load_efficiency_settings, run_efficiency
from laticauda.paper.scores import score_study

settings = replace(
    load_efficiency_settings(), sweeps=load_efficiency_settings().sweeps[:1]
)
study = run_efficiency(settings)

for case in study.cases:
    row = case.measured
    if row.case == 1:
        print(
            f"\n{case.group.name}\n case  amplitude  frequency  phase shift  measured  simulated"
        )
    setting = [
        degrees(angle)
        for angle in (row.gait.amplitude, row.gait.frequency, row.gait.phase_shift)
    ]
    measured = (
        "NA" if row.forward_velocity is None else f"{row.forward_velocity:.4f}"
    )
    print("{:5d} {:10.0f} {:10.0f} {:12.0f}".format(row.case, *setting), end="")
    print(f"{measured:>10} {case.forward_velocity[0]:10.4f} m/s")

print("\nMean error:")
for score in score_study(study):
    print(f"  {score.name:28} {score.overall:5.1f} %")

print("\nThe fin makes it faster by (measured, simulated):")
for gain in find_fin_gains(study.cases):
    change = gain.measured
    if change.velocity is not None:
        simulated = gain.simulated_change(lambda case: case.forward_velocity[0])
        print(
            f"  {change.with_fin.group}, case {change.with_fin.case}: "
            f"{change.velocity:5.1f} %, {simulated:5.1f} %"
        )

figure, ax = plt.subplots(figsize=(5, 5), layout="constrained")
for case in study.cases:
    if case.measured.forward_velocity is not None:
        color = "C1" if "eel" in case.group.name.lower() else "C0"
        marker = "^" if "fin" in case.measured.robot else "o"
        speeds = case.measured.forward_velocity, case.forward_velocity[0]
        ax.plot(*speeds, marker, color=color)
ax.axline((0.1, 0.1), slope=1, color="gray")
ax.set(xlabel="measured [m/s]", ylabel="simulated [m/s]")
ax.set_title(
    "blue: lateral undulation, orange: eel-like; triangles: fin", fontsize=9
)
figure.savefig("table1.png", dpi=150)
