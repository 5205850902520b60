"""One page for all tests of it."""

import pytest

from laticauda.connect.web import export_web

ROBOTS = ("mamba", "mamba-fin")  # for more: campaigns/web_page.py


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("page")
    export_web(place, ROBOTS)
    return place
