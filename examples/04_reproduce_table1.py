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

figure, panels = new_panels(2, height=4.0)
titles = ("the paper's coefficients", "mamba-identified")
for ax, title in zip(panels, titles, strict=True):
    name = "analytical-set" if ax is panels[0] else title
    model = study.models.index(name)
    for group in settings.groups:
        rows = [case for case in study.measured if case.group == group]
        measured = [case.measured.forward_velocity for case in rows]
        simulated = [case.forward_velocity[model] for case in rows]
        color = style.ORANGE if group.gait == "eel_like" else style.BLUE
        marker = "^" if group.has_fin else "o"
        (line,) = ax.plot(
            measured, simulated, marker, color=color, label=group.name
        )
        for case, x, y in zip(rows, measured, simulated, strict=True):
            shift = (4, -3) if case.measured.case % 2 else (-9, -3)
            style.add_note(ax, str(case.measured.case), (x, y), shift)
    ax.axline((0.1, 0.1), slope=1, color=style.GRAY, linewidth=style.THIN)
    ticks = [0.1, 0.15, 0.2, 0.25]
    ax.set(xlim=(0.08, 0.28), ylim=(0.08, 0.28), xticks=ticks, yticks=ticks)
    ax.set_aspect("equal")
    ax.set_title(title, fontsize=style.LABEL, loc="left")
    style.style_axes(ax, xlabel="measured [m/s]", ylabel="simulated [m/s]")
handles, _ = ax.get_legend_handles_labels()
style.outside_legend(figure, handles, "outside lower center", ncols=2)
save_figure(figure, "table1.png")
