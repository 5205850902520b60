from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.image import AxesImage
from matplotlib.quiver import Quiver
from show.figures.runs import WATER, run

from laticauda.show.figures import new_figure, path_strip
from laticauda.water.fluid.flow import Flow, FunctionFlow

WAVE = FunctionFlow(
    function=lambda x, y, z, t: (
        0.2 * np.exp(z) * np.cos(3.0 * x - 2.0 * t),
        0.05 + 0.0 * x,
        *(0.0 * x,) * 13,
        0.1 * np.cos(3.0 * x - 2.0 * t),
    )
)
SHEAR = FunctionFlow(function=lambda x, y, z, t: (0.1 * y, 0.0 * y, 0.0 * y))


def drawn(flow: Flow, depth: float | None = None) -> Any:
    trial = run("lateral")
    water = replace(WATER, current=flow, depth=depth)
    scenario: Any = replace(trial.scenario, environment=water)
    ax = new_figure(7.0, 3.0).add_subplot()
    path_strip(replace(trial, scenario=scenario), ax)
    ax.figure.canvas.draw()
    return ax


def test_arrows_and_shades_are_those_of_the_flow_at_the_depth_and_the_end_of_the_run():
    ax = drawn(WAVE, depth=0.4)
    [quiver, key] = [one for one in ax.collections if isinstance(one, Quiver)]
    arrows = np.column_stack((quiver.U, quiver.V))
    places = np.column_stack((quiver.XY + 0.5 * arrows, np.full(len(arrows), -0.4)))
    velocity = WAVE.velocity(places, 30.0)[:, :2]
    words = next(text.get_text() for text in ax.texts if text.get_text().startswith("water"))
    assert words == "water at 30 s, 0.4 m deep; 0.1 m/s:"
    time = float(key.U[0]) / 0.1
    assert np.allclose(arrows, velocity * time)
    [image] = [one for one in ax.images if isinstance(one, AxesImage)]
    left, right, _, _ = image.get_extent()
    shade = np.asarray(image.get_array())[0]
    assert shade == pytest.approx(0.1 * np.cos(3.0 * np.linspace(left, right, shade.size) - 60.0))
    assert ax.child_axes[0].get_ylabel() == "elevation [m]"


def test_the_field_fills_the_axes_and_hides_no_part_of_the_way():
    ax, plain = drawn(SHEAR), new_figure(7.0, 3.0).add_subplot()
    assert ax.child_axes[0].get_ylabel() == "speed [m/s]"
    [image] = ax.images
    assert (*ax.get_xlim(), *ax.get_ylim()) == tuple(image.get_extent())
    path_strip(run("lateral"), plain)
    (low, high), ends = plain.dataLim.get_points(), np.array((ax.get_xlim(), ax.get_ylim())).T
    assert np.all(ends[0] <= low) and np.all(ends[1] >= high)
