"""Folders for rosbag2: an MCAP file together with the `metadata.yaml` that the tools of ROS 2 expect."""

import json
import shutil
from pathlib import Path

from laticauda.trials import Trial
from laticauda.trials.logs import ros2
from laticauda.trials.logs.recorder import QUALITY
from laticauda.trials.logs.recording import Recording, open_recording
from laticauda.values import StorageFailed, TrialFileError, files

VERSION = 5  # version of metadata.yaml: that of ROS 2 Humble, which every later version reads
METADATA = "metadata.yaml"


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
    place = files.local(folder).absolute()
    file = place / f"{place.name}_0.mcap"
    lost = "" if isinstance(source, Trial) else open_recording(source).lost
    if lost:
        raise TrialFileError(f"{lost} `laticauda replay --save` makes a trial of what there is.")
    try:
        place.mkdir(exist_ok=True)
    except OSError as error:
        raise StorageFailed(
            f"{folder}: cannot be created: {(error.strerror or str(error)).lower()}."
        ) from error
    if any(place.iterdir()):
        raise StorageFailed(f"{folder}: must be a new or an empty folder; name another one.")
    if isinstance(source, Trial):
        source.save(file)
    else:
        files.write(file, lambda new: shutil.copyfile(source, new))
    information = {"rosbag2_bagfile_information": _information(open_recording(file))}
    files.write(place / METADATA, f"{json.dumps(information, indent=2)}\n")  # JSON is valid YAML


def _information(recording: Recording) -> dict[str, object]:
    """Return the contents of `metadata.yaml` that rosbag2 requires."""
    topics = [
        {
            "topic_metadata": {
                "name": name,
                "type": ros2.schema_name(topic.kind),
                "serialization_format": "cdr",
                "offered_qos_profiles": QUALITY.get(name, ""),
            },
            "message_count": topic.n_messages,
        }
        for name, topic in recording.topics.items()
    ]
    start, duration = (
        round(1e9 * one) for one in (recording.start, recording.stop - recording.start)
    )
    span = {
        "duration": {"nanoseconds": duration},
        "starting_time": {"nanoseconds_since_epoch": recording.epoch + start},
        "message_count": sum(topic.n_messages for topic in recording.topics.values()),
    }
    return {
        "version": VERSION,
        "storage_identifier": "mcap",
        "relative_file_paths": [recording.path.name],
        **span,
        "topics_with_message_count": topics,
        "compression_format": "",
        "compression_mode": "",
        "files": [{"path": recording.path.name, **span}],
    }
