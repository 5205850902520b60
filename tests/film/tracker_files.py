"""Files as trackers write them, made from the same points."""

import json
import pickle

import h5py
import numpy as np

NAMES = ("nose", "middle", "tail")
N_FRAMES = 12
FRAME_RATE = 30.0


def positions(n_individuals: int = 1) -> np.ndarray:
    """Positions in px of individuals that swim to the right [frame, individual, point, axis]."""
    frame = np.arange(N_FRAMES)[:, np.newaxis, np.newaxis]
    individual = np.arange(n_individuals)[np.newaxis, :, np.newaxis]
    point = np.arange(len(NAMES))[np.newaxis, np.newaxis, :]
    x = 200.0 + 3.0 * frame - 40.0 * point + 0.0 * individual
    y = 100.0 + 150.0 * individual + 0.5 * frame + 0.0 * point
    return np.stack(np.broadcast_arrays(x, y), axis=-1)


def deeplabcut_columns(individuals: tuple[str, ...] = (), coordinates=("x", "y", "likelihood")):
    columns = []
    for individual in individuals or ("",):
        for name in NAMES:
            for coordinate in coordinates:
                middle = (individual,) if individual else ()
                columns.append(("DLC_resnet50", *middle, name, coordinate))
    return columns


def deeplabcut_numbers(n_individuals: int, n_coordinates: int, likelihood: float = 0.99):
    place = positions(n_individuals)
    sure = np.full((*place.shape[:-1], 1), likelihood)
    return np.concatenate((place, sure), axis=-1)[..., :n_coordinates].reshape(N_FRAMES, -1)


def write_deeplabcut_csv(
    path, individuals=(), *, coordinates=("x", "y", "likelihood"), change=None
):
    columns = deeplabcut_columns(individuals, coordinates)
    heads = ["scorer", *(["individuals"] if individuals else []), "bodyparts", "coords"]
    numbers = deeplabcut_numbers(max(1, len(individuals)), len(coordinates))
    if change is not None:
        change(numbers)
    lines = [",".join([head, *(column[i] for column in columns)]) for i, head in enumerate(heads)]
    for i, row in enumerate(numbers):
        lines.append(",".join([str(i), *("" if np.isnan(x) else f"{x:.6f}" for x in row)]))
    path.write_text("\n".join(lines) + "\n")
    return path


def write_deeplabcut_table(path, individuals=()):
    """As pandas writes `to_hdf(..., format="table")`, the usual one of DeepLabCut."""
    columns = deeplabcut_columns(individuals)
    numbers = deeplabcut_numbers(max(1, len(individuals)), 3)
    rows = np.zeros(N_FRAMES, [("index", "<i8"), ("values_block_0", "<f8", (len(columns),))])
    rows["index"] = np.arange(N_FRAMES)
    rows["values_block_0"] = numbers
    with h5py.File(path, "w") as file:
        group = file.create_group("df_with_missing")
        group.attrs["pandas_type"] = np.bytes_(b"frame_table")
        table = group.create_dataset("table", data=rows)
        table.attrs["values_block_0_kind"] = np.bytes_(pickle.dumps(columns, protocol=0))
    return path


def write_deeplabcut_arrays(path, individuals=()):
    """As pandas writes `to_hdf(..., format="fixed")`."""
    columns = deeplabcut_columns(individuals)
    with h5py.File(path, "w") as file:
        group = file.create_group("df_with_missing")
        group.attrs["pandas_type"] = np.bytes_(b"frame")
        group.attrs["nblocks"] = 1
        group["axis1"] = np.arange(N_FRAMES)
        group["block0_values"] = deeplabcut_numbers(max(1, len(individuals)), 3)
        group.attrs["block0_items_nlevels"] = len(columns[0])
        for level in range(len(columns[0])):
            parts = [column[level] for column in columns]
            known = sorted(set(parts))
            group[f"block0_items_level{level}"] = np.array(known, dtype="S")
            group[f"block0_items_label{level}"] = np.array([known.index(part) for part in parts])
    return path


def write_sleap_hdf(path, tracks=("eel",), *, preset="matlab", states_axes=True):
    place = positions(len(tracks))
    scores = np.full(place.shape[:3], 0.9)
    axes, score_axes = ["frame", "track", "node", "xy"], ["frame", "track", "node"]
    if preset == "matlab":
        place = place.transpose(1, 3, 2, 0)
        scores = scores.transpose(1, 2, 0)
        axes, score_axes = ["track", "xy", "node", "frame"], ["track", "node", "frame"]
    with h5py.File(path, "w") as file:
        file["tracks"] = place
        file["point_scores"] = scores
        if states_axes:
            file["tracks"].attrs["dims"] = json.dumps(axes)
            file["point_scores"].attrs["dims"] = json.dumps(score_axes)
        file["node_names"] = np.array(NAMES, dtype="S")
        file["track_names"] = np.array(tracks, dtype="S")
        file["track_occupancy"] = np.ones((N_FRAMES, len(tracks)), dtype=np.uint8)
        file["edge_names"] = np.array([["nose", "middle"], ["middle", "tail"]], dtype="S")
    return path


def write_sleap_csv(path, tracks=("eel",), *, left_out=()):
    place = positions(len(tracks))
    columns = [f"{name}.{part}" for name in NAMES for part in ("x", "y", "score")]
    lines = [",".join(["track", "frame_idx", "instance.score", *columns])]
    for frame in range(N_FRAMES):
        if frame in left_out:
            continue
        for i, track in enumerate(tracks):
            numbers = [f"{x:.3f},{y:.3f},0.95" for x, y in place[frame, i]]
            lines.append(",".join([track, str(frame), "0.9", *numbers]))
    path.write_text("\n".join(lines) + "\n")
    return path


def trex_fields():
    place = positions()[:, 0, 1]
    x, y = place.T / 10.0  # in cm
    missing = np.zeros(N_FRAMES)
    missing[4] = 1.0
    x[4] = y[4] = np.inf
    return {
        "frame": np.arange(N_FRAMES),
        "time": np.arange(N_FRAMES) / FRAME_RATE,
        "X": x + 1.0,
        "Y": y,
        "X#wcentroid": x,
        "Y#wcentroid": y,
        "missing": missing,
        "cm_per_pixel": np.array([0.1]),
    }


def write_trex_npz(path, **changes):
    np.savez(path, **{**trex_fields(), **changes})
    return path


def write_trex_csv(path):
    fields = trex_fields()
    del fields["cm_per_pixel"]
    units = {"time": "", "frame": "", "missing": ""}
    names = [name if name in units else f"{name} (cm)" for name in fields]
    rows = np.stack(list(fields.values()), axis=1)
    lines = [",".join(names), *(",".join(map(str, row)) for row in rows.tolist())]
    path.write_text("\n".join(lines) + "\n")
    return path


def write_trex_midlines(path):
    place = positions()[:, 0]
    corner = place.min(axis=1)
    lengths = np.full(N_FRAMES, len(NAMES))
    midlines = place - corner[:, np.newaxis]
    np.savez(
        path,
        frames=np.arange(N_FRAMES),
        offset=corner,
        midline_lengths=lengths,
        midline_points=midlines.reshape(-1, 2),
    )
    return path


def write_idtracker_npy(path, n_individuals=2, **changes):
    session = {
        "trajectories": positions(n_individuals)[:, :, 1],
        "id_probabilities": np.ones((N_FRAMES, n_individuals, 1)),
        "frames_per_second": FRAME_RATE,
        "body_length": 80.0,
        "version": "5.2.0",
        **changes,
    }
    np.save(path, np.array(session, dtype=object), allow_pickle=True)
    return path


def write_idtracker_csv(folder, *, states_rate=True):
    place = positions(2)[:, :, 1]
    path = folder / "trajectories.csv"
    lines = ["x1,y1,x2,y2", *(",".join(f"{x:.3f}" for x in row.ravel()) for row in place)]
    path.write_text("\n".join(lines) + "\n")
    if states_rate:
        attributes = {"frames_per_second": FRAME_RATE, "body_length": 80.0}
        (folder / "attributes.json").write_text(json.dumps(attributes))
    return path


def write_plain_csv(path, *, unit="", scale=1.0):
    place = positions()[:, 0] * scale
    ending = f" [{unit}]" if unit else ""
    names = [f"{name}.{axis}{ending}" for name in NAMES for axis in "xy"]
    lines = [",".join(["time", *names])]
    for i, row in enumerate(place):
        lines.append(",".join(map(repr, [i / FRAME_RATE, *row.ravel().tolist()])))
    path.write_text("\n".join(lines) + "\n")
    return path
