"""Folders for rosbag2: an MCAP file together with the `metadata.yaml` that the tools of ROS 2 expect."""

import json
import shutil
from pathlib import Path

from laticauda.trials import Trial
from laticauda.trials.logs import ros2
from laticauda.trials.logs.recorder import QUALITY
from laticauda.trials.logs.recording import Recording, Topic, open_recording
from laticauda.values import StorageFailed, TrialFileError, files

VERSION = 5
"""Version of `metadata.yaml`: that of ROS 2 Humble, which every later version reads."""
METADATA = "metadata.yaml"
"""File beside the MCAP file that describes it, required by the tools of ROS 2."""


def write_bag(source: Trial | str | Path, folder: str | Path) -> None:
    """Write a trial or a recording to a folder that `ros2 bag` and the package `rosbags` can open.

    Args:
        source: A trial, or an MCAP file written by laticauda: a saved trial, or a recording, which
            is copied unchanged.
        folder: A new or empty folder.

    Raises:
        StorageFailed: If the folder is not empty, or cannot be written.
        TrialFileError: If the source is not an MCAP file, or is incomplete.
        MissingExtra: If the package `mcap` is not installed.
    """
    bag = files.local(folder).absolute()
    if not isinstance(source, Trial):
        _check_complete(source)
    _make_empty_folder(bag, folder)
    file = bag / f"{bag.name}_0.mcap"
    if isinstance(source, Trial):
        source.save(file)
    else:
        files.write(file, lambda new_file: shutil.copyfile(source, new_file))
    metadata = {"rosbag2_bagfile_information": _describe_bag(open_recording(file))}
    files.write(bag / METADATA, f"{json.dumps(metadata, indent=2)}\n")  # JSON is valid YAML


def find_file_in_bag(folder: Path) -> Path:
    """Return the MCAP file of a folder for rosbag2.

    Args:
        folder: The folder.

    Raises:
        ValueError: If it holds no MCAP file, or several.
    """
    if not (folder / METADATA).is_file():
        raise ValueError(f"it is a folder without {METADATA}: not a bag; name a file.")
    recordings = sorted(folder.glob("*.mcap"))
    if not recordings:
        raise ValueError(
            "its messages are not in MCAP; run `ros2 bag convert` with `storage_id: mcap`."
        )
    if len(recordings) > 1:
        names = ", ".join(recording.name for recording in recordings)
        raise ValueError(f"it is split into {names}; name one of these files.")
    return recordings[0]


def _check_complete(source: str | Path) -> None:
    """Reject a recording of which something is lost."""
    lost = open_recording(source).lost
    if lost:
        raise TrialFileError(f"{lost} `laticauda replay --save` makes a trial of what there is.")


def _make_empty_folder(bag: Path, name: str | Path) -> None:
    """Make the folder of the bag unless it exists; `name` is what the user calls it."""
    try:
        bag.mkdir(exist_ok=True)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise StorageFailed(f"{name}: cannot be created: {reason}.") from error
    if any(bag.iterdir()):
        raise StorageFailed(f"{name}: must be a new or an empty folder; name another one.")


def _describe_bag(recording: Recording) -> dict[str, object]:
    """Return the contents of `metadata.yaml` that rosbag2 requires."""
    duration = round(1e9 * (recording.stop - recording.start))
    start = round(1e9 * recording.start)
    n_messages = sum(topic.n_messages for topic in recording.topics.values())
    span = {
        "duration": {"nanoseconds": duration},
        "starting_time": {"nanoseconds_since_epoch": recording.epoch + start},
        "message_count": n_messages,
    }
    return {
        "version": VERSION,
        "storage_identifier": "mcap",
        "relative_file_paths": [recording.path.name],
        **span,
        "topics_with_message_count": [
            _describe_topic(name, topic) for name, topic in recording.topics.items()
        ],
        "compression_format": "",
        "compression_mode": "",
        "files": [{"path": recording.path.name, **span}],
    }


def _describe_topic(name: str, topic: Topic) -> dict[str, object]:
    return {
        "topic_metadata": {
            "name": name,
            "type": ros2.schema_name(topic.kind),
            "serialization_format": "cdr",
            "offered_qos_profiles": QUALITY.get(name, ""),
        },
        "message_count": topic.n_messages,
    }
