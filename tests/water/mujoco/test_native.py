"""Fields of MuJoCo's structures are found where they lie, not in what lies behind."""

import numpy as np
import pytest

from laticauda.water.mujoco import native

mujoco = pytest.importorskip("mujoco")


def test_what_lies_behind_a_structure_is_not_taken_for_a_part_of_it():
    memory = np.arange(1, 1025, dtype=np.uint64)
    field, end = memory[600], memory[700]
    memory[705], memory[708] = (
        field,
        end,
    )  # left by another structure, which began eight words further on
    words = native._words(memory.ctypes.data, end, "data")
    assert words[-1] == end and words.size == 701
    assert native._last(words, field, "field") == 600 * 8


def test_the_offsets_hold_for_the_data_of_any_model():
    data = mujoco.MjData(
        mujoco.MjModel.from_xml_string(
            "<mujoco><worldbody><body><joint/><geom size='1'/></body></worldbody></mujoco>"
        )
    )
    words = native._words(data._address, np.uint64(data.signature), "data")
    for name, offset in zip(native.AT._fields, native.offsets(), strict=True):
        there = words[offset // 8]
        if name == "time":
            assert there == np.float64(data.time).view(np.uint64)
        elif getattr(data, name).size:
            assert there == getattr(data, name).ctypes.data
