"""What a picture says about a trial: who swims and how, and its speed."""

import math

import numpy as np

from laticauda.motion.gaits import Gait
from laticauda.show.pictures.camera import estimate_ripple_period
from laticauda.show.pictures.lines import interpolate_centers
from laticauda.trials import Trial


def measure_speed(trial: Trial, time: float) -> float:
    """Return the speed of the center of mass over the last period of the gait, and hence without its ripple [m/s]."""
    begin = max(time - estimate_ripple_period(trial), float(trial.time[0]))
    if begin == time:
        return float(np.linalg.norm(trial.center_of_mass_velocity[0]))
    start, stop = interpolate_centers(trial, (begin, time))
    return float(np.linalg.norm(stop - start)) / (time - begin)


def describe_run(trial: Trial, speed: float = 1.0) -> list[str]:
    """Return text on the robot, its gait, and the playback speed; a run that failed is marked.

    Args:
        trial: Any trial.
        speed: Playback speed; 2 is twice as fast [-].
    """
    name = trial.robot.name
    if not trial.succeeded:
        name = f"FAILED: {name}"
    if speed != 1.0:
        name += f"  (shown at {speed:g} times its speed)"
    gait = trial.gait
    if gait is None:
        return [name]
    lines = [name, _describe_wave(gait)]
    if gait.pitch is not None:
        amplitude = math.degrees(gait.pitch.amplitude)
        phase = math.degrees(gait.pitch.phase)
        lines.append(f"pitch wave, {amplitude:.0f}°, {phase:.0f}° ahead")
    if gait.fin is not None:
        amplitude = math.degrees(gait.fin.amplitude)
        frequency = math.degrees(gait.fin.frequency)
        lines.append(f"fin, {amplitude:.0f}°, {frequency:.0f}°/s")
    return lines


def _describe_wave(gait: Gait) -> str:
    """Return the kind of gait, and its parameters unless a recorded motion is all of it."""
    amplitude = math.degrees(gait.amplitude)
    frequency = math.degrees(gait.frequency)
    phase_shift = math.degrees(gait.phase_shift)
    offset = math.degrees(gait.offset)
    text = gait.words
    if amplitude or not gait.recorded:
        text += f", {amplitude:.3g}°, {frequency:.3g}°/s, phase shift {phase_shift:.3g}°"
    if offset:
        text += f", offset {offset:.3g}°"
    return text
