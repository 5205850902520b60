"""The drawing of a design: its words and numbers can be read."""

from dataclasses import replace
from itertools import combinations

import pytest

import laticauda as lc
from laticauda.show.reports import draw_design_sheet

GAIT = lc.eel_like(amplitude=0.5, frequency=3.0, phase_shift=0.6)


@pytest.fixture(scope="module")
def figure():
    robot = lc.load_robot("chain")
    long_modules = tuple(replace(module, length=0.18) for module in robot.modules)
    longer = replace(robot, name="chain-design", modules=long_modules)
    scenarios = [lc.build_scenario(body, GAIT, 3.0) for body in (robot, longer)]
    figure = draw_design_sheet(*scenarios)
    figure.canvas.draw()
    return figure


def test_no_number_lies_over_another_or_over_an_axis(figure):
    plan = figure.axes[3]
    boxes = [text.get_window_extent() for text in plan.texts]
    assert len(boxes) == 1 + 2 * 10
    for first, second in combinations(boxes, 2):
        assert not first.overlaps(second)
    bottom = plan.get_window_extent().y0
    assert min(box.y0 for box in boxes) > bottom


def test_a_robot_without_fin_is_measured_from_its_tail(figure):
    assert figure.axes[3].get_xlabel() == "from the tail toward the head [mm]"
