"""The map of the gaits around what swims: trials over amplitude and frequency, as numbers and as a picture."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportAttributeAccessIssue=false
# pyright: reportUnknownArgumentType=false

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

import laticauda as lc
from laticauda.figures import style
from laticauda.studies.trials import QUANTITIES

AMPLITUDES = tuple(float(value) for value in range(5, 65, 5))  # [deg]
FREQUENCIES = tuple(float(value) for value in range(20, 220, 20))  # [deg/s]
OF_GAITS = ("forward_velocity", "mean_power", "cost_of_transport")
DURATION = 20.0  # of every trial [s]
SIZE = (3.4, 2.55)  # [in]
BOX = (0.17, 0.19, 0.65, 0.68)  # of the axes in the picture: left, bottom, width, height, as shares
Values = Float[np.ndarray, "n_frequencies n_amplitudes"]


class Picture(NamedTuple):
    """A picture of the map, for a screen, and what its axes, in `BOX`, go from and to."""

    pixels: Any
    limits: tuple[tuple[float, float], tuple[float, float]]


def base_of(scenario: lc.Scenario) -> lc.Scenario:
    """What the map depends on: scenarios with equal ones share it. It is in the plane, without steering.

    Args:
        scenario: What swims how.
    """
    gait = replace(scenario.gait, amplitude=0.0, frequency=0.0)
    return replace(scenario, motion=gait, model=lc.Planar(joints=scenario.model.joints))


def map_of_gaits(scenario: lc.Scenario) -> dict[str, Values]:
    """Trials of `DURATION` from rest side by side: each of `OF_GAITS`, over frequency and amplitude.

    Args:
        scenario: What swims how.

    Raises:
        ValueError: If the batch cannot compute such trials.
    """
    base = replace(base_of(scenario), duration=DURATION, sample_interval=0.05)
    gaits = [with_wave(base.gait, amplitude, frequency) for frequency in FREQUENCIES for amplitude in AMPLITUDES]
    swims = lc.swim_many([replace(base, motion=gait) for gait in gaits])
    return {name: np.asarray(getattr(swims, name)).reshape(len(FREQUENCIES), len(AMPLITUDES)) for name in OF_GAITS}


def with_wave(gait: lc.Gait, amplitude_deg: float, frequency_deg_s: float) -> lc.Gait:
    """The gait with another amplitude [deg] and frequency [deg/s]."""
    return replace(gait, amplitude=math.radians(amplitude_deg), frequency=math.radians(frequency_deg_s))


def gait_map_picture(values: Values, quantity: str) -> Picture:
    """A quantity as colors over amplitude and frequency; gray where a trial failed.

    Args:
        values: Of every trial.
        quantity: One of `OF_GAITS`.
    """
    figure = style.new_figure(*SIZE)
    figure.set_layout_engine("none")
    figure.set_dpi(220)
    ax = figure.add_axes(BOX)
    ax.set_facecolor("#c8c8c8")
    mesh = ax.pcolormesh(AMPLITUDES, FREQUENCIES, np.ma.masked_invalid(values), shading="nearest")
    style.dress(ax, xlabel="amplitude [deg]", ylabel="frequency [deg/s]")
    unit = QUANTITIES[quantity][0]
    title = f"{quantity.replace('_', ' ').capitalize()} [{'-' if unit == '1' else unit}]"
    ax.set_title(title, fontsize=style.LABEL, color=style.INK)
    bar: Any = figure.colorbar(mesh, cax=ax.inset_axes((1.04, 0.0, 0.05, 1.0)))
    bar.ax.tick_params(labelsize=style.TICK, labelcolor=style.INK)
    bar.outline.set_visible(False)
    canvas: Any = figure.canvas
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3].copy()
    return Picture(pixels=pixels, limits=(ax.get_xlim(), ax.get_ylim()))
