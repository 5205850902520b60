"""C3D files of any length and with any number of markers: every frame that a file holds is read, or it is refused."""

import numpy as np
import pytest
from c3d_files import BLOCK, DEC, INTEL, SGI, C3d, actual_fields, track

from laticauda.trials.logs.c3d import read_c3d
from laticauda.trials.logs.c3d_frames import read_frames, read_layout

ezc3d = pytest.importorskip("ezc3d")
LONG = 70_000
FORMS = {
    "header full, as ezc3d writes": {"last": 65535, "n_in_parameters": 65535},
    "header full, counted from 0": {"first": 0, "last": 65534, "n_in_parameters": 65535},
    "header full, first frame 100": {"first": 100, "last": 65535, "n_in_parameters": 65535},
    "header wrapped around": {"last": LONG, "n_in_parameters": LONG},
    "header wrapped within the run": {"first": 60_000, "n_in_parameters": LONG},
    "long frames": {
        "last": 65535,
        "n_in_parameters": 65535,
        "parameters": {"POINT": {"LONG_FRAMES": float(LONG)}},
    },
    "actual fields, as Vicon writes": {
        "last": 65535,
        "n_in_parameters": 65535,
        "parameters": actual_fields(1, LONG),
    },
    "actual fields from frame 66000": {
        "first": 65535,
        "last": 65535,
        "n_in_parameters": 65535,
        "parameters": actual_fields(66_000, 66_000 + LONG - 1),
    },
    "actual fields, full as the header": {
        "last": 65535,
        "n_in_parameters": 65535,
        "parameters": actual_fields(1, 65535),
    },
    "actual fields, header wrapped": {
        "n_in_parameters": LONG,
        "parameters": actual_fields(1, LONG),
    },
    "frames of -1": {"last": 65535, "n_in_parameters": -1},
}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("n_points", [1, 3])
def test_all_frames_of_a_long_file_are_read_however_it_counts_them(tmp_path, form, n_points):
    points = track(LONG, n_points)
    table = read_c3d(C3d(points, **FORMS[form]).write(tmp_path / "long.c3d"))
    assert table.n_rows == LONG
    for i in range(n_points):
        for axis, name in enumerate("XYZ"):
            np.testing.assert_allclose(table[f"m{i} {name}"], points[:, i, axis], atol=0.01)
    assert str(LONG) in table.remarks[0]


@pytest.mark.parametrize("n_frames", [65533, 65534, 65535, 65536, 65537, 131071, 131072, 140_000])
@pytest.mark.parametrize("is_wrapped", [False, True])
def test_a_file_at_the_ends_of_16_bits_has_its_number_of_rows(tmp_path, n_frames, is_wrapped):
    header = {} if is_wrapped else {"last": min(n_frames, 65535)}
    header["n_in_parameters"] = n_frames if is_wrapped else min(n_frames, 65535)
    table = read_c3d(C3d(track(n_frames), **header).write(tmp_path / "long.c3d"))
    assert table.n_rows == n_frames


@pytest.mark.parametrize("processor", [INTEL, DEC, SGI])
@pytest.mark.parametrize("is_integer", [False, True])
def test_own_reading_of_frames_gives_the_numbers_of_the_library(tmp_path, processor, is_integer):
    random = np.random.default_rng(1)
    points = random.uniform(-3000.0, 3000.0, (50, 3, 3))
    analog = np.round(random.uniform(-1000.0, 1000.0, (50, 4, 2)))
    file = C3d(points, analog, is_integer=is_integer)
    content = ezc3d.c3d(str(file.write(tmp_path / "short.c3d")))
    file.processor = processor  # the library knows no SGI
    path = file.write(tmp_path / "other.c3d")
    frames = read_frames(path, read_layout(path), 50, content["parameters"])
    assert frames.position == pytest.approx(content["data"]["points"][:3], abs=1e-3)
    assert frames.position.T == pytest.approx(points, abs=0.06)
    if processor != SGI:
        library_analog = ezc3d.c3d(str(path))["data"]["analogs"][0].reshape(frames.analog.shape)
        assert frames.analog == pytest.approx(library_analog, abs=1e-4)
    assert frames.analog == pytest.approx(np.moveaxis(analog - 10.0, 2, 0), abs=1e-6)
    assert not np.any(frames.is_lost)


@pytest.mark.parametrize("processor", [INTEL, DEC])
@pytest.mark.parametrize("is_integer", [False, True])
def test_a_long_file_of_any_processor_has_its_analog_channels_too(tmp_path, processor, is_integer):
    points = track(66_000, 2)
    points[:, :, 0] %= 3000.0  # within what integers can hold
    analog = np.arange(66_000 * 4.0).reshape(-1, 2, 2) % 1000.0
    file = C3d(points, analog, last=65535, n_in_parameters=65535)
    file.processor, file.is_integer = processor, is_integer
    table = read_c3d(file.write(tmp_path / "long.c3d"))
    np.testing.assert_allclose(table["m1 X"], points[:, 1, 0], atol=0.06)
    np.testing.assert_allclose(table["a1"], analog[:, :, 1].mean(axis=1) - 10.0, atol=1e-3)


@pytest.mark.parametrize("n_points", [255, 256, 300, 511, 600])
def test_markers_and_channels_beyond_255_have_their_names(tmp_path, n_points):
    points = track(20, n_points)
    analog = np.ones((20, 2, n_points)) * np.arange(n_points)
    table = read_c3d(C3d(points, analog).write(tmp_path / "many.c3d"))
    assert len(table.columns) == 4 * n_points
    for i in (0, n_points - 1):
        assert table[f"m{i} Y"] == pytest.approx(points[:, i, 1], abs=0.01)
        assert table[f"a{i}"] == pytest.approx(i - 10.0)


def test_a_lost_marker_of_a_long_file_is_lost(tmp_path):
    points = track(LONG, 2)
    points[66_000:66_005, 1] = 0.0
    table = read_c3d(C3d(points, last=65535, n_in_parameters=65535).write(tmp_path / "long.c3d"))
    assert np.flatnonzero(np.isnan(table["m1 X"])).tolist() == list(range(66_000, 66_005))


@pytest.mark.parametrize(
    ("form", "message"),
    [
        ("long frames", "it must have 70000 frames, as POINT:LONG_FRAMES counts, got 67"),
        (
            "actual fields, as Vicon writes",
            "it must have 70000 frames, as TRIAL:ACTUAL_END_FIELD counts, got 67",
        ),
        ("header full, as ezc3d writes", "no whole blocks: it is cut off"),
        ("header wrapped around", "its header counts 4464 frames, but its length is that of 67"),
        (
            "actual fields, header wrapped",
            "counts 4464 frames, TRIAL:ACTUAL_END_FIELD 70000, but its length is that of 67",
        ),
    ],
)
def test_a_long_file_without_its_end_is_refused(tmp_path, form, message):
    path = C3d(track(LONG), **FORMS[form]).write(tmp_path / "cut.c3d")
    content = path.read_bytes()
    path.write_bytes(content[: int(0.96 * len(content))])
    with pytest.raises(ValueError, match=message):
        read_c3d(path)


def test_a_long_file_that_ends_within_a_frame_is_refused(tmp_path):
    path = C3d(track(LONG, 3), last=65535, n_in_parameters=65535).write(tmp_path / "cut.c3d")
    content = path.read_bytes()
    path.write_bytes(content[: (len(content) // BLOCK - 100) * BLOCK])
    with pytest.raises(ValueError, match="it ends within a frame: it is cut off"):
        read_c3d(path)


def test_parameters_that_contradict_the_length_are_refused(tmp_path):
    parameters = {"POINT": {"LONG_FRAMES": 68_000.0}}
    file = C3d(track(LONG), last=65535, n_in_parameters=65535, parameters=parameters)
    message = "POINT:LONG_FRAMES counts 68000 frames, but its length is that of 700"
    with pytest.raises(ValueError, match=message):
        read_c3d(file.write(tmp_path / "long.c3d"))


@pytest.mark.parametrize("n_blocks", [1, 3, 200])
def test_zeros_behind_the_frames_are_no_frames_and_anything_else_is_refused(tmp_path, n_blocks):
    file = C3d(track(1000), tail=bytes(n_blocks * BLOCK))
    assert read_c3d(file.write(tmp_path / "zeros.c3d")).n_rows == 1000
    file.tail = b"more" * (n_blocks * BLOCK // 4)
    with pytest.raises(ValueError, match="its header counts 1000 frames, but its length is that"):
        read_c3d(file.write(tmp_path / "more.c3d"))


def test_rotations_behind_the_frames_of_a_long_file_are_no_frames(tmp_path):
    plain = C3d(track(LONG), last=65535, n_in_parameters=65535)
    path = plain.write(tmp_path / "long.c3d")
    # The group of rotations lengthens the parameters by less than a block.
    plain.tail = bytes(range(1, 129)) * 128
    for _ in range(2):
        begin = path.stat().st_size // BLOCK - len(plain.tail) // BLOCK * bool(plain.parameters)
        plain.parameters = {"ROTATION": {"DATA_START": begin + 1, "USED": 0, "RATE": 100.0}}
        path = plain.write(tmp_path / "long.c3d")
    assert read_c3d(path).n_rows == LONG


def test_unsigned_samples_have_no_sign(tmp_path):
    analog = np.full((66_000, 1, 1), 60_000.0)
    file = C3d(track(66_000), analog, last=65535, n_in_parameters=65535, is_integer=True)
    file.points[:, :, 0] %= 3000.0
    file.parameters = {"ANALOG": {"FORMAT": ["UNSIGNED"]}}
    table = read_c3d(file.write(tmp_path / "long.c3d"))
    np.testing.assert_allclose(table["a0"], 60_000.0 - 10.0)
