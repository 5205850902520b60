"""A lamprey swims with its spinal cord cut: twenty networks of oscillators, intact,
cut between all joints, and cut but told by the skin what the water does.

Cut apart, every oscillator keeps its own time, and the body hardly moves. Told of
the pressure, all find one rhythm again, which body and water set. On the picture:
the bend of the joints of the first network, and the speed of all; below zero, a robot
swims tail first.

    python examples/27_severed_lamprey.py
"""

from dataclasses import replace

import numpy as np

import laticauda as lc
from laticauda.control import Feedback, PhaseOscillators
from laticauda.models.simulate import swim_side_by_side
from laticauda.show.figures import new_panels, save_figure, style

DURATION = 40.0
gait = lc.lateral_undulation(
    amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40
)
intact = PhaseOscillators(gait=gait, spread=0.05)
cut = replace(intact, cuts=tuple(range(7)))
states = {
    "intact": intact,
    "cut": cut,
    "cut, and feels": replace(cut, feedback=Feedback(pressure=0.08, stretch=-3)),
}


def forward_speed(trial):
    """Speed along the body, over the second half [m/s]."""
    half = len(trial.time) // 2
    velocity = trial.center_of_mass_velocity[half:]
    heading = trial.heading[half:]
    ahead = np.stack((np.cos(heading), np.sin(heading)), axis=1)
    return float(np.mean(np.sum(velocity * ahead, axis=1)))


scenario = lc.build_scenario("mamba", intact, DURATION, joints="ekeberg")
figure, panels = new_panels(4, width=7.2, height=2.8)
for column, (name, network) in enumerate(states.items()):
    scenarios = [
        replace(scenario, motion=replace(network, seed=seed)) for seed in range(20)
    ]
    trials = swim_side_by_side(scenarios)
    speeds = np.array([forward_speed(trial) for trial in trials])
    print(
        f"{name}: {np.median(abs(speeds)):.3f} m/s, "
        f"{np.sum(speeds < -0.01)} of 20 tail first"
    )
    ax = panels[column]
    is_shown = trials[0].time > DURATION - 8
    bend = np.degrees(trials[0].joint_angle[is_shown])
    time = trials[0].time[is_shown]
    for joint in range(8):
        line = joint + bend[:, joint] / 60
        ax.plot(time, line, color=style.BLUE, linestyle="-", linewidth=0.9)
    ylabel = "joint, from the tail" if column == 0 else ""
    style.style_axes(ax, xlabel="time [s]", ylabel=ylabel)
    ax.set_title(name, fontsize=style.LABEL)
    spread = column + 0.02 * (np.arange(20) - 9.5)
    panels[3].plot(spread, speeds, ".", color=style.BLUE)
panels[3].axhline(0.0, color=style.GRAY, linewidth=0.6)
panels[3].set_xticks(range(3), ["intact", "cut", "feels"])
style.style_axes(panels[3], xlabel="", ylabel="forward speed [m/s]")
panels[3].set_title("20 networks", fontsize=style.LABEL)
save_figure(figure, "severed-lamprey.png")
