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
robot = lc.load_robot("mamba")
guess = lc.load_water("paper-lateral")
truth = replace(
    guess, tangential_friction=0.2, normal_drag=1.4, current=(0.01, -0.02)
)
noise = {"center_of_mass": 0.003, "heading": 0.01}  # standard deviations [m], [rad]
measurements: list[Measurement] = []
for k, phase_shift in enumerate((0.5, 0.7, 0.9)):
    gait = lc.lateral_undulation(
        amplitude=0.5, frequency=1.6, phase_shift=phase_shift, offset=0.03
    )
    trial = lc.swim(robot, gait, 12.0, environment=truth)
    position_error = 0.003 * rng.standard_normal(trial.center_of_mass.shape)
    heading_error = 0.01 * rng.standard_normal(trial.heading.shape)
    tracked = replace(
        trial,
        center_of_mass=trial.center_of_mass + position_error,
        heading=trial.heading + heading_error,
    )
    # The fit takes it that it started approximately where it was first seen.
    measurement = from_trial(tracked, name=f"trial {k}", series=noise, every=5)
    scenario = replace(measurement.scenario, environment=guess)
    measurements.append(replace(measurement, scenario=scenario))

names = [
    "water.tangential_friction",
    "water.normal_drag",
    "water.current_x",
    "water.current_y",
    "water.added_inertia",
]
result = fit(measurements, parameters=names)

print(result.status)
for name in names:
    estimate = result[name]
    if estimate.interval is None:
        print(f"  {estimate.name:<26} {estimate.note}")
    else:
        low, high = estimate.interval
        print(
            f"  {estimate.name:<26} {estimate.value:8.4f} [{low:.4f}, {high:.4f}] "
            f"{estimate.unit}"
        )
print(f"friction and drag are correlated: {result.correlations[0, 1]:+.2f}")
problem = result.problem
deviation = leave_out(result).predictions - problem.observed
error = np.sqrt(np.mean(deviation**2 / problem.sigma**2))
print(
    f"trials that the fit did not see are predicted to {error:.2f} times the noise"
)

figure, panels = new_panels(4, height=2.4)
true_values = (0.2, 1.4, 0.01, -0.02)
for ax, name, true_value in zip(panels, names, true_values, strict=False):
    estimate = result[name]
    low, high = estimate.interval
    errors = [[estimate.value - low], [high - estimate.value]]
    ax.errorbar(0, estimate.value, errors, fmt="o", capsize=5, color=style.BLUE)
    ax.axhline(true_value, **style.AIM)
    label = name.removeprefix("water.").replace("_", " ")
    style.style_axes(ax, xlabel="", ylabel=f"{label} [{estimate.unit or '-'}]")
    ax.set_xticks([])
style.add_title(figure, "Identified, with 95 % intervals; dashed: the truth")
save_figure(figure, "identified.png")
