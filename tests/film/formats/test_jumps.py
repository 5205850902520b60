"""Tracks that go on elsewhere, and clocks in another unit, are refused with what to do."""

import numpy as np
import pytest

from laticauda.film import read_points
from laticauda.values import TrialFileError

N_FRAMES = 30


def write_table(path, *, step=1 / 30, shift=(), back_at=N_FRAMES):
    lines = ["time,nose.x,nose.y,tail.x,tail.y"]
    for frame in range(N_FRAMES):
        x = 200.0 + 2.0 * frame
        y = 100.0
        if shift and shift[0] <= frame < back_at:
            y += shift[1]
        lines.append(f"{frame * step:.4f},{x},{y},{x - 80.0},{y}")
    path.write_text("\n".join(lines) + "\n")
    return path


def test_a_track_that_another_individual_takes_over_is_refused(tmp_path):
    path = write_table(tmp_path / "swapped.csv", shift=(15, 150.0))
    with pytest.raises(
        TrialFileError, match=r"swapped.csv.*jump by 150 px, 1.9 body lengths, from 0.466"
    ):
        read_points(path)


def test_a_tracker_that_errs_in_one_frame_is_no_jump(tmp_path):
    path = write_table(tmp_path / "erring.csv", shift=(15, 150.0), back_at=16)
    assert read_points(path).n_frames == N_FRAMES


def test_a_swim_without_a_jump_is_read(tmp_path):
    points = read_points(write_table(tmp_path / "swim.csv"))
    assert np.isfinite(points.position).all()


def test_times_in_ms_without_a_unit_are_no_seconds(tmp_path):
    path = write_table(tmp_path / "clock.csv", step=33.3)
    with pytest.raises(TrialFileError, match=r"clock.csv.*33.3 s apart.*in ms\?.*`time \[ms\]`"):
        read_points(path)
