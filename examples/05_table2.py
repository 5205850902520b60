"""One trial of the paper's Table 2: measured, and simulated with the raw heading
and with its mean over the gait cycle.

The paper states neither how fast an offset takes effect nor which heading is
used; both affect the speed.

    python examples/05_table2.py
"""

from dataclasses import replace

import matplotlib.pyplot as plt

from laticauda.paper import load_path_following_settings, run_path_following

settings = load_path_following_settings()
first = replace(settings.groups[0], figures=settings.groups[0].figures[:1])
study = run_path_following(
    replace(settings, groups=(first,), joint_laws=("prescribed",))
)

(case,) = study.cases
print(
    f"{case.group.name}, case {case.measured.case}, p_y = "
    f"{case.measured.initial_cross_track_error} m"
)
print(f"measured {case.measured.forward_velocity:.4f} m/s")
for run in (*case.band, case.cycle_mean):
    print(
        f"{run.name}: {run.forward_velocity:.4f} m/s, at most "
        f"{run.last_third_largest:.3f} m off in the last third"
    )

figure, ax = plt.subplots(figsize=(7, 3), layout="constrained")
runs = (*case.band, case.cycle_mean)
ax.barh([run.name for run in runs], [run.forward_velocity for run in runs])
ax.axvline(case.measured.forward_velocity, color="C1", label="measured")
ax.set_xlabel("forward velocity [m/s]")
ax.legend(loc="lower left")
figure.savefig("table2.png", dpi=150)
