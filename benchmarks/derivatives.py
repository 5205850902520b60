"""What does a derivative cost?

Question: ten links, 30 s, prescribed joints: time of one core per trial and parameter of the gait,
against a trial of a batch, and against central differences (two trials per parameter). And the same for
the derivatives of one figure of a trial to everything that the kernels read, and to 60 numbers of its
modules, backward in time.
"""

import time

from _timing import fastest, of_links, print_load, random_gaits

import laticauda as lc
from laticauda.models.simulate import compute_sensitivities, runs_of
from laticauda.models.simulate.gradients import FigureOfRun, compute_row_gradients

NAMES = ("gait.amplitude", "gait.frequency", "gait.phase_shift", "gait.offset")
QUANTITIES = ("length", "mass", "center", "normal_drag", "section.half_height", "added_mass")
NAMES_OF_MODULES = [f"robot.module[{i}].{quantity}" for i in range(10) for quantity in QUANTITIES]
TRIALS = 64
MANY_TRIALS = 256


def main() -> None:
    """Print the table."""
    robot = of_links(10)
    gaits = random_gaits(TRIALS)

    def swim_batch() -> object:
        return lc.swim_many(robot, gaits * 8, threads=1)

    def differentiate() -> object:
        return compute_sensitivities(robot, gaits, names=NAMES, threads=1)

    trial = fastest(time.process_time, swim_batch) / (8 * TRIALS)
    n_derivatives = TRIALS * len(NAMES)
    derivative = fastest(time.process_time, differentiate) / n_derivatives
    alone = fastest(time.perf_counter, lambda: compute_sensitivities(robot, gaits[0], names=NAMES))
    print(f"trial of a batch               {1e3 * trial:7.3f} ms")
    print(f"derivative to one parameter    {1e3 * derivative:7.3f} ms, x {derivative / trial:.1f}")
    runs = runs_of([lc.build_scenario(robot, gait) for gait in gaits])
    speeds = [FigureOfRun(i, "forward_velocity") for i in range(TRIALS)]

    def go_backward() -> object:
        return compute_row_gradients(runs, speeds, 30.0, threads=1)

    gradient = fastest(time.process_time, go_backward) / TRIALS
    n_rows = runs[0].rows.size
    times_of_modules = {n: _time_modules(robot, n) for n in (TRIALS, MANY_TRIALS)}
    print(f"of one figure, to all {n_rows} rows {1e3 * gradient:5.3f} ms, x {gradient / trial:.1f}")
    for n_trials, seconds in times_of_modules.items():
        label = f"to 60 numbers, batch of {n_trials}"
        print(f"{label:<30} {1e3 * seconds:7.3f} ms, x {seconds / trial:.1f}")
    print(f"by two trials                  {2e3 * trial:7.3f} ms, x 2.0")
    print(f"gradient of one trial, 4 parameters, wall {1e3 * alone:.1f} ms")
    print_load()


def _time_modules(robot: lc.Robot, n_trials: int) -> float:
    """Time of one core per trial for one figure's derivatives to 60 numbers of its modules [s]."""
    gaits = random_gaits(n_trials)

    def differentiate() -> object:
        return compute_sensitivities(
            robot, gaits, names=NAMES_OF_MODULES, figures=["forward_velocity"], threads=1
        )

    return fastest(time.process_time, differentiate, 3) / n_trials


if __name__ == "__main__":
    main()
