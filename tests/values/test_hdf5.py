"""Damaged HDF5 files of which their library never returns are refused before it sees them."""

import numpy as np
import pytest
import xarray

from laticauda.values.hdf5 import (
    HEAP_HEAD,
    HEAP_SIGNATURE,
    OBJECT_HEAD,
    check_heaps,
)
from laticauda.water.fluid.gridded import Gridded


@pytest.fixture
def flow_file(tmp_path):
    """A flow on a grid, whose names of dimensions stand in a global heap."""
    axes = {"time": [0.0, 1.0], "y": [0.0, 1.0, 2.0], "x": [0.0, 1.0, 2.0]}
    values = np.zeros((2, 3, 3))
    variables = {name: (tuple(axes), values, {"units": "m/s"}) for name in "uv"}
    units = {"time": "s", "y": "m", "x": "m"}
    coordinates = {name: (name, axes[name], {"units": units[name]}) for name in axes}
    path = tmp_path / "flow.nc"
    xarray.Dataset(variables, coordinates).to_netcdf(path, engine="netcdf4")
    return path


def change_size_of_first_object(path, size):
    content = bytearray(path.read_bytes())
    place = content.index(HEAP_SIGNATURE) + HEAP_HEAD.size
    index, references, zeros, _ = OBJECT_HEAD.unpack_from(content, place)
    OBJECT_HEAD.pack_into(content, place, index, references, zeros, size)
    path.write_bytes(content)
    return place


def test_intact_files_and_files_of_other_formats_pass(flow_file, tmp_path):
    check_heaps(flow_file)
    text = tmp_path / "log.csv"
    text.write_bytes(b"time,x\n" + HEAP_SIGNATURE)
    check_heaps(text)


@pytest.mark.parametrize("size", [9, 2**40, 2**64 - 1])
def test_an_object_of_a_wrong_size_is_refused_with_its_byte(flow_file, size):
    change_size_of_first_object(flow_file, size)
    with pytest.raises(ValueError, match=r"it is damaged at or before byte \d+"):
        check_heaps(flow_file)


def test_a_heap_that_is_cut_off_is_refused(flow_file):
    content = flow_file.read_bytes()
    heap = content.index(HEAP_SIGNATURE)
    flow_file.write_bytes(content[: heap + 10])
    with pytest.raises(ValueError, match=f"it is damaged at or before byte {heap}"):
        check_heaps(flow_file)


def test_a_gridded_flow_on_which_its_library_would_hang_is_refused_by_name(flow_file):
    change_size_of_first_object(flow_file, 9)
    with pytest.raises(
        ValueError,
        match=r"must be a netCDF file that holds a flow, got .*flow\.nc: it is damaged at or before",
    ):
        Gridded(source=str(flow_file))
