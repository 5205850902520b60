"""Trained policies without the library that trained them: layers of tanh or relu, as arrays in .npz files.

A file holds weights of several runs, `w0`, `b0`, `w1`, ..., with the run as the first axis, and
`activation`, a string. The environment clips the output at -1 and 1; `squash` says that a tanh
limits it before that.
"""

from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

ACTIVATIONS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "tanh": np.tanh,
    "relu": lambda x: np.maximum(x, 0.0),
}


class Layer(NamedTuple):
    """A layer of a network."""

    weights: np.ndarray
    """Weights (n_out, n_in) [-]."""
    biases: np.ndarray
    """Biases (n_out,) [-]."""


Layers = Sequence[Layer]


class Network:
    """A policy: layers, with an activation between them.

    Args:
        layers: Weights (n_out, n_in) and biases of each layer.
        activation: tanh or relu.
        squash: Whether tanh follows the last layer.
    """

    def __init__(self, layers: Layers, activation: str, squash: bool) -> None:
        self.layers = layers
        self.activation = activation
        self.squash = squash

    def __call__(self, observed: np.ndarray) -> np.ndarray:
        """Return actions for observations, one row each; the sums do not depend on the number of rows."""
        activate = ACTIVATIONS[self.activation]
        *hidden_layers, last_layer = self.layers
        signals = observed
        for layer in hidden_layers:
            signals = activate(_weighted_sums(layer, signals))
        outputs = _weighted_sums(last_layer, signals)
        if self.squash:
            return np.tanh(outputs)
        return outputs


def _weighted_sums(layer: Layer, signals: np.ndarray) -> np.ndarray:
    return np.einsum("ij,kj->ki", layer.weights, signals) + layer.biases


@cache
def load(file: Path) -> list[Network]:
    """Return the networks in a file, one per run."""
    with np.load(file, allow_pickle=False) as archive:
        arrays = {name: archive[name] for name in archive.files}
    n_layers = sum(name.startswith("w") for name in arrays)
    activation = str(arrays["activation"])
    squash = bool(arrays["squash"])
    networks: list[Network] = []
    for run in range(len(arrays["w0"])):
        layers: list[Layer] = []
        for i in range(n_layers):
            weights = arrays[f"w{i}"][run].astype(float)
            biases = arrays[f"b{i}"][run].astype(float)
            layers.append(Layer(weights, biases))
        networks.append(Network(layers, activation, squash))
    return networks


def save(file: Path, runs: Sequence[Layers], activation: str, squash: bool) -> None:
    """Write networks of the same shape, in half precision: what is scored is what is stored.

    Args:
        file: Path of the file.
        runs: Layers of each run.
        activation: tanh or relu.
        squash: Whether tanh follows the last layer.
    """
    arrays: dict[str, np.ndarray] = {
        "activation": np.array(activation),
        "squash": np.array(squash),
    }
    for i in range(len(runs[0])):
        weights = np.stack([layers[i].weights for layers in runs])
        biases = np.stack([layers[i].biases for layers in runs])
        arrays[f"w{i}"] = weights.astype(np.float16)
        arrays[f"b{i}"] = biases.astype(np.float16)
    np.savez_compressed(file, allow_pickle=False, **arrays)
