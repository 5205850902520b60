"""Draw the pictures of the docs: `python docs/images/make.py`. The same code always gives the same files."""

from math import radians
from pathlib import Path

import laticauda as lc
from laticauda.figures import save_figure, swim_sheet

FOLDER = Path(__file__).parent

gait = lc.lateral_undulation(amplitude=radians(30), frequency=radians(130), phase_shift=radians(40))
save_figure(swim_sheet(lc.swim(lc.load_robot("mamba"), gait)), FOLDER / "swim.png")
