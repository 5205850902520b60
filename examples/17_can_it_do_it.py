"""Can this robot do it? What the gaits in the docs require of every preset, and
what those of Table 1 require of Mamba's joints in each model.

The real Mamba swam all of Table 1. A row that exceeds its published servo (2.9 N m,
7.5 rad/s) therefore means that the model's water or joints demand too much, or that
there is more gearing between servo and joint than was published.

    python examples/17_can_it_do_it.py
"""

from math import degrees

import laticauda as lc
from laticauda.paper.measured import read_efficiency_trials
from laticauda.robot import load_parameters, parameter_names, robot_names
from laticauda.show.figures import new_panels, save_figure, style
from laticauda.trials.feasibility import judge_feasibility

MARKERS = "os^D"
COLORS = (style.BLUE, style.ORANGE, style.AMBER, style.INK)
KINDS = {"lateral": lc.lateral_undulation, "eel": lc.eel_like}
SETTINGS = [  # amplitude [deg], frequency [deg/s], phase shift [deg]
    ("lateral", 30, 130, 40),
    ("lateral", 30, 90, 40),
    ("eel", 50, 110, 40),
    ("eel", 40, 90, 40),
]

print(
    "share used of joints, motors and room, 30 s with prescribed joints and the "
    "default water; above 1: beyond it"
)
heads = [f"{kind:>9} {a} {w:>3} {d}" for kind, a, w, d in SETTINGS]
print(" " * 18 + "".join(heads))
gaits = [
    KINDS[kind](amplitude_deg=a, frequency_deg_s=w, phase_shift_deg=d)
    for kind, a, w, d in SETTINGS
]
figure, (ax,) = new_panels(height=4.2)
for name in robot_names():
    shares = [lc.swim(name, gait).utilization for gait in gaits]
    line = f"{name:18}" + "".join(f"{share:19.2f}" for share in shares)
    if not lc.load_robot(name).joints[0].actuator.stated:
        line += "  no actuator is stated"
    print(line)
    ax.plot(shares, [name] * len(shares), color=style.GRID, linestyle="-", zorder=0)
    for share, marker, color in zip(shares, MARKERS, COLORS, strict=True):
        ax.plot(share, name, marker, color=color, markersize=5)
handles = []
for setting, marker, color in zip(SETTINGS, MARKERS, COLORS, strict=True):
    label = "{}: {}°, {}°/s, {}°".format(*setting)
    handles += ax.plot([], [], marker, color=color, label=label)
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

rows = read_efficiency_trials()
for name in parameter_names():
    model = load_parameters(name)
    joints = model.joints or "prescribed"
    print(f"\n{name}: {joints} joints")
    n_beyond, largest_torque = 0, 0.0
    for row in rows:
        gait = row.gait
        published = lc.load_robot(row.robot)
        robot = model.robot(published, gait.kind)
        water = model.water(gait.kind)
        trial = lc.swim(robot, gait, environment=water, joints=joints)
        # The same motion and torques with the published servo.
        verdict = judge_feasibility(published, trial, trial.period)
        if verdict.problems:
            n_beyond += 1
        largest_torque = max(largest_torque, verdict.figures["peak_joint_torque"])
        print(
            f"  {row.robot:9} {gait.words:18} {degrees(gait.amplitude):3.0f} deg "
            f"{degrees(gait.frequency):4.0f} deg/s "
            f"{degrees(gait.phase_shift):3.0f} deg "
            f"{verdict.figures['utilization']:6.2f}  "
            f"{'; '.join(verdict.problems) or 'feasible'}"
        )
    print(
        f"  {n_beyond} of {len(rows)} rows are beyond the servo; "
        f"the largest torque is {largest_torque:.1f} N m"
    )
