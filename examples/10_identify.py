"""What are the coefficients of this water, and which of them can be determined
from a few tracked trials?

python examples/10_identify.py
"""

from dataclasses import replace

import numpy as np

import laticauda as lc
from laticauda.identify import Measurement, fit, from_trial, leave_out
from laticauda.show.figures import new_panels, save_figure, style

# Instead of a tank: three trials in water whose coefficients the fit does not
# know, recorded by a noisy tracker.
rng = np.random.default_rng(1)
robot, guess = lc.load_robot("mamba"), lc.load_water("paper-lateral")
truth = replace(
    guess, tangential_friction=0.2, normal_drag=1.4, current=(0.01, -0.02)
)
measured: list[Measurement] = []
for k, phase_shift in enumerate((0.5, 0.7, 0.9)):
    gait = lc.lateral_undulation(
        amplitude=0.5, frequency=1.6, phase_shift=phase_shift, offset=0.03
    )
    trial = lc.swim(robot, gait, 12.0, environment=truth)
    tracked = replace(
        trial,
        center_of_mass=trial.center_of_mass
        + 0.003 * rng.standard_normal(trial.center_of_mass.shape),
        heading=trial.heading + 0.01 * rng.standard_normal(trial.heading.shape),
    )
    noise = {
        "center_of_mass": 0.003,
        "heading": 0.01,
    }  # standard deviations [m], [rad]
    seen = from_trial(tracked, name=f"trial {k}", series=noise, every=5)
    # it started approximately where it was first seen
    measured.append(
        replace(seen, scenario=replace(seen.scenario, environment=guess))
    )

names = [
    "water.tangential_friction",
    "water.normal_drag",
    "water.current_x",
    "water.current_y",
    "water.added_inertia",
]
found = fit(measured, parameters=names)

print(found.status)
for estimate in (found[name] for name in names):
    if estimate.interval is None:
        print(f"  {estimate.name:<26} {estimate.note}")
    else:
        low, high = estimate.interval
        print(
            f"  {estimate.name:<26} {estimate.value:8.4f} [{low:.4f}, {high:.4f}] "
            f"{estimate.unit}"
        )
print(f"friction and drag are correlated: {found.correlations[0, 1]:+.2f}")
left = leave_out(found)
error = np.sqrt(
    np.mean(
        (left.predictions - found.problem.observed) ** 2 / found.problem.sigma**2
    )
)
print(
    f"trials that the fit did not see are predicted to {error:.2f} times the noise"
)

figure, panels = new_panels(4, height=2.4)
truths = (0.2, 1.4, 0.01, -0.02)
for ax, name, true in zip(panels, names, truths, strict=False):
    estimate = found[name]
    low, high = estimate.interval
    errors = [[estimate.value - low], [high - estimate.value]]
    ax.errorbar(0, estimate.value, errors, fmt="o", capsize=5, color=style.BLUE)
    ax.axhline(true, **style.AIM)
    label = name.removeprefix("water.").replace("_", " ")
    style.style_axes(ax, xlabel="", ylabel=f"{label} [{estimate.unit or '-'}]")
    ax.set_xticks([])
style.add_title(figure, "Identified, with 95 % intervals; dashed: the truth")
save_figure(figure, "identified.png")
