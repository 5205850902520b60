"""C3D files written byte by byte, with headers and parameters as programs write them that the package ezc3d is not.

The format: blocks of 512 bytes; a header, parameters, and frames of points and analog samples.
"""

import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

BLOCK = 512
INTEL, DEC, SGI = 84, 85, 86
INTEGER_SCALE = 0.1


@dataclass
class C3d:
    """A file; its markers are m0, m1, ... [mm], its channels a0, a1, ..."""

    points: np.ndarray
    """Frames x markers x 3 [mm]."""
    analog: np.ndarray | None = None
    """Frames x samples x channels."""
    first: int = 1
    """Number of the first frame in the header."""
    last: int | None = None
    """Number of the last frame in the header; None: with the 16 bits that it has."""
    n_in_parameters: int | None = None
    """POINT:FRAMES; None: as in the header."""
    parameters: dict[str, dict[str, Any]] = field(default_factory=dict)
    """Further parameters by group."""
    processor: int = INTEL
    is_integer: bool = False
    is_padded: bool = True
    """Whether the last block is whole."""
    tail: bytes = b""
    """What follows the frames."""

    def write(self, path: Path) -> Path:
        n_frames, n_points = self.points.shape[:2]
        last = self.first + n_frames - 1 if self.last is None else self.last
        n_header = n_frames if self.n_in_parameters is None else self.n_in_parameters
        scale = INTEGER_SCALE if self.is_integer else -1.0
        groups: dict[str, dict[str, Any]] = {
            "POINT": {
                "USED": n_points,
                "SCALE": scale,
                "RATE": 100.0,
                "FRAMES": n_header % 65536,
                "UNITS": ["mm"] * min(n_points, 1),
                **numbered("LABELS", [f"m{i}" for i in range(n_points)]),
            },
            "ANALOG": {"USED": 0},
        }
        n_samples = n_channels = 0
        if self.analog is not None:
            n_samples, n_channels = self.analog.shape[1:]
            groups["ANALOG"] = {
                "USED": n_channels,
                "RATE": 100.0 * n_samples,
                "GEN_SCALE": 0.5,
                **numbered("LABELS", [f"a{i}" for i in range(n_channels)]),
                **numbered("SCALE", [2.0] * n_channels),
                **numbered("OFFSET", [10] * n_channels),
            }
        for group, values in self.parameters.items():
            groups.setdefault(group, {}).update(values)
        groups["POINT"]["DATA_START"] = 0
        n_blocks = -(-len(self._section(groups)) // BLOCK)
        groups["POINT"]["DATA_START"] = 2 + n_blocks
        section = bytearray(self._section(groups).ljust(n_blocks * BLOCK, b"\0"))
        section[:4] = bytes([1, 0x50, n_blocks, self.processor])
        header = bytearray(BLOCK)
        header[:2] = bytes([2, 0x50])
        numbers = (n_points, n_samples * n_channels, self.first % 65536, last % 65536, 10)
        header[2:12] = self._words(numbers)
        header[12:16] = self._floats([scale])
        header[16:20] = self._words((2 + n_blocks, n_samples))
        header[20:24] = self._floats([100.0])
        frames = self._frames()
        if self.is_padded:
            frames = frames.ljust(-(-len(frames) // BLOCK) * BLOCK, b"\0")
        path.write_bytes(bytes(header) + bytes(section) + frames + self.tail)
        return path

    def _frames(self) -> bytes:
        n_frames = len(self.points)
        residual = np.ones((*self.points.shape[:2], 1))
        position = self.points
        if self.is_integer:
            position = np.round(self.points / INTEGER_SCALE)
        parts = [np.concatenate((position, residual), axis=2).reshape(n_frames, -1)]
        if self.analog is not None:
            parts.append(self.analog.reshape(n_frames, -1))
        numbers = np.concatenate(parts, axis=1)
        return self._words(numbers) if self.is_integer else self._floats(numbers)

    def _words(self, numbers: Any) -> bytes:
        order = ">" if self.processor == SGI else "<"
        return (np.asarray(numbers).astype(np.int64) % 65536).astype(f"{order}u2").tobytes()

    def _floats(self, numbers: Any) -> bytes:
        if self.processor == SGI:
            return np.asarray(numbers).astype(">f4").tobytes()
        if self.processor == DEC:
            words = (4.0 * np.asarray(numbers)).astype("<f4").reshape(-1).view("<u2")
            return words.reshape(-1, 2)[:, ::-1].tobytes()
        return np.asarray(numbers).astype("<f4").tobytes()

    def _section(self, groups: dict[str, dict[str, Any]]) -> bytes:
        section = bytearray(4)
        for number, (group, values) in enumerate(groups.items(), start=1):
            section += struct.pack("bb", len(group), -number) + group.encode()
            section += self._words([3]) + b"\0"
            for name, value in values.items():
                content = self._content(value)
                section += struct.pack("bb", len(name), number) + name.encode()
                section += self._words([2 + len(content) + 1]) + content + b"\0"
        return bytes(section) + b"\0\0"

    def _content(self, value: Any) -> bytes:
        values = value if isinstance(value, list) else [value]
        dimensions = bytes([1, len(values)]) if isinstance(value, list) else b"\0"
        if values and isinstance(values[0], str):
            width = max(map(len, values))
            texts = "".join(text.ljust(width) for text in values).encode()
            return b"\xff" + bytes([2, width, len(values)]) + texts
        if values and isinstance(values[0], float):
            return b"\x04" + dimensions + self._floats(values)
        return b"\x02" + dimensions + self._words(values)


def numbered(name: str, values: list) -> dict[str, list]:
    """Parameters of at most 255 values each: NAME, NAME2, NAME3, ..."""
    pieces = [values[i : i + 255] for i in range(0, len(values), 255)]
    return {f"{name}{i + 1 if i else ''}": piece for i, piece in enumerate(pieces)}


def actual_fields(first: int, last: int) -> dict[str, dict[str, list[int]]]:
    """The group TRIAL, with frames of two words each."""
    ends = {"ACTUAL_START_FIELD": first, "ACTUAL_END_FIELD": last}
    return {"TRIAL": {name: [end % 65536, end // 65536] for name, end in ends.items()}}


def track(n_frames: int, n_points: int = 1) -> np.ndarray:
    """0.15 m/s from 1 m on [mm], every marker 50 mm to the left of the one before."""
    points = np.full((n_frames, n_points, 3), 10.0)
    points[:, :, 0] = 1e3 + 1.5 * np.arange(n_frames)[:, np.newaxis]
    points[:, :, 1] = 10.0 + 50.0 * np.arange(n_points)
    return points
