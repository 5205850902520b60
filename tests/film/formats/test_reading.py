import pickle

import numpy as np
import pytest
from film import tracker_files as made

from laticauda.film.formats import read_points
from laticauda.values import TrialFileError


def test_every_format_gives_the_same_points(tmp_path):
    files = [
        (made.write_deeplabcut_csv(tmp_path / "a.csv"), made.FRAME_RATE),
        (made.write_deeplabcut_table(tmp_path / "b.h5"), made.FRAME_RATE),
        (made.write_deeplabcut_arrays(tmp_path / "c.h5"), made.FRAME_RATE),
        (made.write_sleap_hdf(tmp_path / "d.h5"), made.FRAME_RATE),
        (made.write_sleap_hdf(tmp_path / "e.h5", states_axes=False), made.FRAME_RATE),
        (made.write_sleap_hdf(tmp_path / "f.h5", preset="standard"), made.FRAME_RATE),
        (made.write_sleap_csv(tmp_path / "g.csv"), made.FRAME_RATE),
        (made.write_plain_csv(tmp_path / "h.csv"), None),
        (made.write_plain_csv(tmp_path / "i.csv", unit="px"), None),
        (made.write_trex_midlines(tmp_path / "eel_posture_id0.npz"), made.FRAME_RATE),
    ]
    for path, rate in files:
        points = read_points(path, frame_rate=rate)
        assert points.unit == "px"
        assert points.n_points == 3
        assert points.position == pytest.approx(made.positions()[:, 0], abs=1e-3), path.name
        assert points.time == pytest.approx(np.arange(made.N_FRAMES) / made.FRAME_RATE)


def test_of_several_individuals_one_is_chosen_by_name_and_otherwise_all_are_listed(tmp_path):
    names = ("eel_1", "eel_2")
    files = [
        made.write_deeplabcut_csv(tmp_path / "a.csv", names),
        made.write_deeplabcut_table(tmp_path / "b.h5", names),
        made.write_deeplabcut_arrays(tmp_path / "c.h5", names),
        made.write_sleap_hdf(tmp_path / "d.h5", names),
        made.write_sleap_csv(tmp_path / "e.csv", names),
    ]
    for path in files:
        points = read_points(path, frame_rate=30.0, individual="eel_2")
        assert points.individual == "eel_2"
        assert points.position == pytest.approx(made.positions(2)[:, 1], abs=1e-3), path.name
        with pytest.raises(ValueError) as error:
            read_points(path, frame_rate=30.0)
        assert str(error.value) == ("`individual` must be one of `eel_1`, `eel_2`: the file has 2.")
        with pytest.raises(ValueError, match="got 'eel_3'; did you mean `eel_"):
            read_points(path, frame_rate=30.0, individual="eel_3")


def test_a_file_without_a_frame_rate_is_refused_until_it_is_given(tmp_path):
    path = made.write_deeplabcut_csv(tmp_path / "a.csv")
    with pytest.raises(ValueError) as error:
        read_points(path)
    assert str(error.value) == (
        "`frame_rate` must be given, in frames per second of the film: DeepLabCut does not state it."
    )


def test_a_frame_rate_against_that_of_the_file_is_refused(tmp_path):
    path = made.write_idtracker_npy(tmp_path / "trajectories.npy")
    assert read_points(path, individual="1").frame_rate == pytest.approx(30.0)
    with pytest.raises(ValueError, match="must be that of the file, 30 frames per second"):
        read_points(path, individual="1", frame_rate=60.0)


def test_a_frame_rate_that_makes_a_fish_a_bullet_is_refused(tmp_path):
    path = made.write_deeplabcut_csv(tmp_path / "a.csv")
    with pytest.raises(TrialFileError, match="body lengths per second; is the frame rate of 30000"):
        read_points(path, frame_rate=30000.0)


def test_metres_that_are_pixels_and_pixels_that_are_metres_are_refused(tmp_path):
    path = made.write_plain_csv(tmp_path / "a.csv", unit="m")
    with pytest.raises(
        TrialFileError, match="its body is 80 m long; are the positions in px or mm"
    ):
        read_points(path)
    path = made.write_plain_csv(tmp_path / "b.csv", scale=1e-3)
    with pytest.raises(TrialFileError, match=r"all lie within 0\.11 px; are they in m"):
        read_points(path)
    path = made.write_plain_csv(tmp_path / "c.csv", unit="mm")
    assert read_points(path).position == pytest.approx(1e-3 * made.positions()[:, 0])


def test_points_less_likely_than_the_floor_are_lost_and_the_notes_say_so(tmp_path):
    def doubt_the_nose(numbers):
        numbers[3:6, 2] = 0.1

    path = made.write_deeplabcut_csv(tmp_path / "a.csv", change=doubt_the_nose)
    points = read_points(path, frame_rate=30.0)
    assert (~points.is_seen[:, 0]).nonzero()[0].tolist() == [3, 4, 5]
    assert points.notes == ("8.3% of all points are less likely than 0.6 and were taken for lost.",)
    assert read_points(path, frame_rate=30.0, likelihood_floor=0.0).is_seen.all()


def test_missing_likelihoods_and_empty_frames_are_said(tmp_path):
    def empty_a_frame(numbers):
        numbers[5] = np.nan

    path = made.write_deeplabcut_csv(
        tmp_path / "a.csv", coordinates=("x", "y"), change=empty_a_frame
    )
    points = read_points(path, frame_rate=30.0)
    assert not points.is_seen[5].any()
    assert points.notes == (
        "1 of 12 frames are empty.",
        "The file has no likelihoods: every point counts.",
    )


def test_frames_that_sleap_leaves_out_are_empty_ones(tmp_path):
    points = read_points(made.write_sleap_csv(tmp_path / "a.csv", left_out=(4, 5)), frame_rate=30.0)
    assert points.n_frames == made.N_FRAMES
    assert "2 of 12 frames are empty." in points.notes


def test_trex_is_in_cm_with_y_down_and_its_missing_frames_are_lost(tmp_path):
    for path in (
        made.write_trex_npz(tmp_path / "film_id0.npz"),
        made.write_trex_csv(tmp_path / "film_id0.csv"),
    ):
        points = read_points(path)
        assert points.individual == "id0"
        assert points.names == ("head", "wcentroid")
        assert points.unit == "m"
        expected = made.positions()[:, 0, 1] * [1e-3, -1e-3]
        seen = points.is_seen[:, 1]
        assert seen.tolist() == [i != 4 for i in range(made.N_FRAMES)]
        assert points.position[seen, 1] == pytest.approx(expected[seen])
        assert "unless `cm_per_pixel` was set" in points.notes[0]


def test_trex_s_pose_is_taken_before_its_centers(tmp_path):
    place = made.positions()[:, 0]
    pose = {f"pose{axis}{i}": place[:, i, k] for i in range(3) for k, axis in enumerate("XY")}
    points = read_points(made.write_trex_npz(tmp_path / "film_fish0.npz", **pose))
    assert points.unit == "px"
    assert points.names == ("pose0", "pose1", "pose2")


def test_idtracker_s_trajectories_are_centroids_of_individuals(tmp_path):
    for path in (
        made.write_idtracker_npy(tmp_path / "trajectories.npy"),
        made.write_idtracker_csv(tmp_path),
    ):
        points = read_points(path, individual="2")
        assert points.names == ("centroid",)
        assert points.position[:, 0] == pytest.approx(made.positions(2)[:, 1, 1], abs=1e-3)
        assert points.frame_rate == pytest.approx(30.0)


class Trap:
    """A pickle of it would make a file."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return (open, (str(self.path), "w"))


def test_nothing_that_a_pickle_names_is_run(tmp_path):
    mark = tmp_path / "was_run"
    path = made.write_idtracker_npy(tmp_path / "trajectories.npy", trap=Trap(mark))
    assert read_points(path, individual="1").n_points == 1
    assert not mark.exists()
    pickle.loads(pickle.dumps(Trap(mark))).close()
    assert mark.exists()


REFUSED = {
    "labels.csv": (
        "scorer,me,me\nbodyparts,nose,nose\ncoords,x,y\nlabeled-data/film/img01.png,1,2\n",
        "its first column must count frames, got 'labeled-data/film/img01.png'",
    ),
    "header.csv": (
        "scorer,me,me\nnose,nose,nose\n0,1,2\n",
        "its first rows must begin with scorer",
    ),
    "twice.csv": (
        "scorer,me,me\nbodyparts,nose,nose\ncoords,x,y\n0,1,2\n0,3,4\n",
        "it must have one row for each frame",
    ),
    "half.csv": (
        "scorer,me\nbodyparts,nose\ncoords,x\n0,1\n1,2\n",
        "it must have x and y of every point, got no y of `nose`",
    ),
    "words.csv": (
        "scorer,me,me\nbodyparts,nose,nose\ncoords,x,y\n0,one,2\n",
        "must hold numbers, got 'one' in row 4",
    ),
    "untracked.csv": (
        "track,frame_idx,nose.x,nose.y\n,0,1,2\n,0,30,40\n",
        "frame 0 has 2 individuals without a track; track them in SLEAP first",
    ),
    "points.csv": (
        "video_path,frame_idx,track,node,x,y,score\na.mp4,0,eel,nose,1,2,0.9\n",
        "export it as SLEAP's analysis CSV",
    ),
    "frames.csv": (
        "track,frame_idx,nose.x,nose.y\neel,-3,1,2\n",
        "its numbers of frames must count from 0, got -3 to -3",
    ),
    "other.csv": ("a,b\n1,2\n", "it must be one of these: DeepLabCut CSV or HDF5"),
    "empty.csv": ("", "it must be one of these"),
    "damaged.h5": (b"\x89HDF\r\n\x1a\nrubbish", "it is no HDF5 file, or damaged"),
    "damaged.npy": (b"\x93NUMPY\x01\x00rubbish", "it is no array of NumPy, or damaged"),
    "damaged.npz": (b"PK\x03\x04rubbish", "it is no archive of NumPy, or damaged"),
    "project.slp": (b"\x89HDF\r\n\x1a\n", "it is a project of SLEAP; export its analysis"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_odd_files_are_refused_by_name(name, tmp_path):
    content, message = REFUSED[name]
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(TrialFileError) as error:
        read_points(path, frame_rate=30.0)
    assert name in str(error.value)
    assert message in str(error.value)


def test_files_that_are_cut_off_are_refused_never_a_traceback(tmp_path):
    whole = [
        made.write_deeplabcut_table(tmp_path / "a.h5"),
        made.write_sleap_hdf(tmp_path / "b.h5"),
        made.write_trex_npz(tmp_path / "c_id0.npz"),
        made.write_idtracker_npy(tmp_path / "d.npy"),
    ]
    for path in whole:
        content = path.read_bytes()
        for share in (0.02, 0.3, 0.6, 0.9):
            path.write_bytes(content[: int(share * len(content))])
            with pytest.raises(TrialFileError):
                read_points(path, frame_rate=30.0, individual="1")


def test_semicolons_and_decimal_commas_of_a_spreadsheet_are_read(tmp_path):
    path = made.write_deeplabcut_csv(tmp_path / "a.csv")
    path.write_text(path.read_text().replace(",", ";").replace(".", ","))
    points = read_points(path, frame_rate=30.0)
    assert points.position == pytest.approx(made.positions()[:, 0])
