"""Table 1 of the paper, simulated with the paper's own coefficients and compared
with the measurements on the robot.

`run_efficiency` repeats the whole study; this example runs only the table.
`laticauda reproduce` runs all of it, draws the figures and writes a report.

    python examples/04_reproduce_table1.py
"""

from dataclasses import replace
from math import degrees

from laticauda.paper import find_fin_gains, load_efficiency_settings, run_efficiency
from laticauda.paper.scores import score_study
from laticauda.show.figures import new_panels, save_figure, style

settings = load_efficiency_settings()
table1 = replace(settings, sweeps=settings.sweeps[:1])
study = run_efficiency(table1)

for case in study.cases:
    row = case.measured
    if row.case == 1:
        print(f"\n{case.group.name}")
        print(" case  amplitude  frequency  phase shift  measured  simulated")
    gait = row.gait
    measured = "NA"
    if row.forward_velocity is not None:
        measured = f"{row.forward_velocity:.4f}"
    print(
        f"{row.case:5d} {degrees(gait.amplitude):10.0f} "
        f"{degrees(gait.frequency):10.0f} {degrees(gait.phase_shift):12.0f}"
        f"{measured:>10} {case.forward_velocity[0]:10.4f} m/s"
    )

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

MODELS = {
    "the paper's coefficients": "analytical-set",
    "mamba-identified": "mamba-identified",
}
COLORS = {"eel_like": style.ORANGE, "lateral_undulation": style.BLUE}
MARKERS = {True: "^", False: "o"}  # with and without the fin
figure, panels = new_panels(2, height=4.0)
for ax, (title, name) in zip(panels, MODELS.items(), strict=True):
    model = study.models.index(name)
    for group in table1.groups:
        cases = [case for case in study.measured if case.group == group]
        measured = [case.measured.forward_velocity for case in cases]
        simulated = [case.forward_velocity[model] for case in cases]
        color, marker = COLORS[group.gait], MARKERS[group.has_fin]
        ax.plot(measured, simulated, marker, color=color, label=group.name)
        for case, x, y in zip(cases, measured, simulated, strict=True):
            number = case.measured.case
            right, left = (4, -3), (-9, -3)  # of the marker
            beside = right if number % 2 else left
            style.add_note(ax, str(number), (x, y), beside)
    ax.axline((0.1, 0.1), slope=1, color=style.GRAY, linewidth=style.THIN)
    ticks = [0.1, 0.15, 0.2, 0.25]
    ax.set(xlim=(0.08, 0.28), ylim=(0.08, 0.28), xticks=ticks, yticks=ticks)
    ax.set_aspect("equal")
    ax.set_title(title, fontsize=style.LABEL, loc="left")
    style.style_axes(ax, xlabel="measured [m/s]", ylabel="simulated [m/s]")
handles, _ = ax.get_legend_handles_labels()
style.outside_legend(figure, handles, "outside lower center", ncols=2)
save_figure(figure, "table1.png")
