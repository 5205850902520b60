"""Can this robot do it? What the gaits in the docs require of every preset, and
what those of Table 1 require of Mamba's joints in each model.

The real Mamba swam all of Table 1. A row that exceeds its published servo (2.9 N m,
7.5 rad/s) therefore means that the model's water or joints demand too much, or that
there is more gearing between servo and joint than was published.

    python examples/17_can_it_do_it.py
"""

import math

import laticauda as lc
from laticauda.paper.measured import read_efficiency_trials
from laticauda.robot import load_parameters, parameter_names, robot_names
from laticauda.show.figures import new_panels, save_figure, style
from laticauda.trials.feasibility import judge_feasibility

COLORS = (style.BLUE, style.ORANGE, style.AMBER, style.INK)
KINDS = {"lateral": lc.lateral_undulation, "eel": lc.eel_like}
GAITS = [
    ("lateral", 30, 130, 40),
    ("lateral", 30, 90, 40),
    ("eel", 50, 110, 40),
    ("eel", 40, 90, 40),
]

print(
    "share used of joints, motors and room, 30 s with prescribed joints and the "
    "default water; above 1: beyond it"
)
print(" " * 18 + "".join(f"{kind:>9} {a} {w:>3} {d}" for kind, a, w, d in GAITS))
figure, (ax,) = new_panels(height=4.2)
for name in robot_names():
    gaits = [
        KINDS[kind](amplitude_deg=a, frequency_deg_s=w, phase_shift_deg=d)
        for kind, a, w, d in GAITS
    ]
    stated = (
        ""
        if lc.load_robot(name).joints[0].actuator.stated
        else "  no actuator is stated"
    )
    shares = [lc.swim(name, gait).utilization for gait in gaits]
    print(f"{name:18}" + "".join(f"{share:19.2f}" for share in shares) + stated)
    ax.plot(shares, [name] * len(shares), color=style.GRID, linestyle="-", zorder=0)
    for share, marker, color in zip(shares, "os^D", COLORS, strict=True):
        ax.plot(share, name, marker, color=color, markersize=5)
handles = [
    ax.plot([], [], marker, color=color, label=f"{kind}: {a}°, {w}°/s, {d}°")[0]
    for (kind, a, w, d), marker, color in zip(GAITS, "os^D", COLORS, strict=True)
]
ax.axvline(1.0, **style.AIM)
style.add_note(ax, "limit", (1.0, 0.0), (4, 0), color=style.ORANGE)
ax.set_xscale("log")
ticks = [0.3, 0.5, 1.0, 2.0, 3.0]
ax.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
ax.minorticks_off()
ax.invert_yaxis()
style.style_axes(ax, xlabel="share of the limit used [-]", ylabel="")
style.outside_legend(figure, handles, "outside lower center", ncols=2)
save_figure(figure, "can-it.png")

for name in parameter_names():
    model = load_parameters(name)
    print(f"\n{name}: {model.joints or 'prescribed'} joints")
    n_beyond, most = 0, 0.0
    for row in read_efficiency_trials():
        published = lc.load_robot(row.robot)
        robot, water = (
            model.robot(published, row.gait.kind),
            model.water(row.gait.kind),
        )
        trial = lc.swim(
            robot, row.gait, environment=water, joints=model.joints or "prescribed"
        )
        # the same motion and torques with the published servo
        found = judge_feasibility(published, trial, trial.period)
        n_beyond += bool(found.problems)
        most = max(most, found.figures["peak_joint_torque"])
        setting = [
            math.degrees(angle)
            for angle in (
                row.gait.amplitude,
                row.gait.frequency,
                row.gait.phase_shift,
            )
        ]
        where = "{:9} {:18} {:3.0f} deg {:4.0f} deg/s {:3.0f} deg".format(
            row.robot, row.gait.words, *setting
        )
        print(
            f"  {where} {found.figures['utilization']:6.2f}  "
            f"{'; '.join(found.problems) or 'feasible'}"
        )
    print(
        f"  {n_beyond} of {len(read_efficiency_trials())} rows are beyond the servo; "
        f"the largest torque is {most:.1f} N m"
    )
