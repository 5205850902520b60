"""One page for all tests of it."""

import pytest

from laticauda.connect.web import export_web
from laticauda.sensing import Seabed, Wall

# Near the start: the picture keeps its scale.
PLACES = (Wall(name="quay", begin=(-0.5, 0.8), end=(0.5, 0.8)), Seabed(depth=3.0))
ROBOTS = ("mamba", "mamba-fin")  # for more: campaigns/web_page.py


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("page")
    export_web(place, ROBOTS, places=PLACES)
    return place
