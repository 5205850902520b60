"""One trial of the paper's Table 2: measured, and simulated with the raw heading
and with its mean over the gait cycle.

The paper states neither how fast an offset takes effect nor which heading is
used; both affect the speed.

    python examples/05_table2.py
"""

from dataclasses import replace

from laticauda.paper import load_path_following_settings, run_path_following
from laticauda.show.figures import new_panels, save_figure, style

settings = load_path_following_settings()
first = replace(settings.groups[0], figures=settings.groups[0].figures[:1])
study = run_path_following(
    replace(settings, groups=(first,), joint_laws=("prescribed",))
)

(case,) = study.cases
measured = case.measured.forward_velocity
paper_runs = (*case.band, case.cycle_mean)
print(
    f"{case.group.name}, case {case.measured.case}, p_y = "
    f"{case.measured.initial_cross_track_error} m"
)
print(f"measured {measured:.4f} m/s")
for run in paper_runs:
    print(
        f"{run.name}: {run.forward_velocity:.4f} m/s, at most "
        f"{run.last_third_largest:.3f} m off in the last third"
    )

figure, (ax,) = new_panels(height=2.2)
speeds = {}
for run in paper_runs:
    heading = run.heading_estimate.replace("_", " ")
    label = f"paper, {run.offset_bandwidth:g} rad/s, {heading}"
    speeds[label] = run.forward_velocity
for own_study in study.own:
    label = own_study.settings.coefficients.name
    speeds[label] = own_study.cases[0].run.forward_velocity
bars = ax.barh([*speeds], [*speeds.values()], color=style.BLUE)
ax.bar_label(
    bars, fmt="%.4f", label_type="center", color="white", fontsize=style.TICK
)
ax.axvline(measured, **style.AIM)
style.add_note(
    ax, f"measured: {measured:.4f}", (measured, -0.5), (6, 0), color=style.ORANGE
)
ax.set_xlim(0.0, 0.135)
ax.invert_yaxis()
style.style_axes(ax, xlabel="forward velocity [m/s]", ylabel="")
save_figure(figure, "table2.png")
