"""Trained policies without the library that trained them: layers of tanh or relu, as arrays in .npz files.

A file holds weights of several runs, `w0`, `b0`, `w1`, ..., with the run as the first axis, and
`activation`, a string. The environment clips the output at -1 and 1; `squash` says that a tanh
limits it before that.
"""

from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

import numpy as np

ACTIVATIONS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "tanh": np.tanh,
    "relu": lambda x: np.maximum(x, 0.0),
}
Layers = Sequence[tuple[np.ndarray, np.ndarray]]


class Network:
    """A policy: layers, with an activation between them.

    Args:
        layers: Weights (n_out, n_in) and biases of each layer.
        activation: tanh or relu.
        squash: Whether tanh follows the last layer.
    """

    def __init__(self, layers: Layers, activation: str, squash: bool) -> None:
        self.layers, self.activation, self.squash = layers, activation, squash

    def __call__(self, observed: np.ndarray) -> np.ndarray:
        """Return actions for observations, one row each; the sums do not depend on the number of rows."""
        now, bend = observed, ACTIVATIONS[self.activation]
        for i, (w, b) in enumerate(self.layers):
            now = np.einsum("ij,kj->ki", w, now) + b
            if i + 1 < len(self.layers):
                now = bend(now)
        return np.tanh(now) if self.squash else now


@cache
def load(file: Path) -> list[Network]:
    """Return the networks in a file, one per run."""
    with np.load(file, allow_pickle=False) as found:
        held = {name: found[name] for name in found.files}
    n_layers = sum(name.startswith("w") for name in held)
    return [
        Network(
            [
                (held[f"w{i}"][run].astype(float), held[f"b{i}"][run].astype(float))
                for i in range(n_layers)
            ],
            str(held["activation"]),
            bool(held["squash"]),
        )
        for run in range(len(held["w0"]))
    ]


def save(file: Path, runs: Sequence[Layers], activation: str, squash: bool) -> None:
    """Write networks of the same shape, in half precision: what is scored is what is stored.

    Args:
        file: Path of the file.
        runs: Layers of each run.
        activation: tanh or relu.
        squash: Whether tanh follows the last layer.
    """
    held: dict[str, np.ndarray] = {"activation": np.array(activation), "squash": np.array(squash)}
    for i in range(len(runs[0])):
        for j, name in enumerate("wb"):
            held[f"{name}{i}"] = np.stack([run[i][j] for run in runs]).astype(np.float16)
    np.savez_compressed(file, allow_pickle=False, **held)
