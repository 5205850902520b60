"""The planar kernels on a GPU: the same functions, compiled by numba-cuda, one thread per run.

Experimental: an H100 and numba-cuda's simulator have run them. A run's rows are one column of an
array, so that neighboring threads read neighboring numbers. sin, cos and exp are mostly those of CUDA, and
its compiler fuses multiplications and additions in its own way: results agree with the processor's
to rounding, not to the last digit.
"""

# pyright: basic, reportMissingImports=false

import functools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any, TypeVar, cast, no_type_check

import numba_cuda as _  # noqa: F401  # it puts itself in the place of the module that numba has
import numpy as np
from numba import cuda
from numba.cuda import config

from laticauda.compiling import Target
from laticauda.compiling.functions import (
    COSINE,
    HALF_PI,
    HALF_PI_REST,
    HALF_PI_REST_OF_REST,
    SINE,
    TWO_PER_PI,
)
from laticauda.models.planar import (
    PATH_ROWS,
    Block,
    Device,
    PlanarPlant,
    Run,
    block_of,
    columns_of,
    kinds_of,
    rows,
    specialize,
)
from laticauda.models.planar.model import RUN, RUN_PRESCRIBED
from laticauda.values import BadArgument, scalars

Result = TypeVar("Result")

config.CUDA_LOW_OCCUPANCY_WARNINGS = 0  # few runs leave it idle, as the documentation says
_THREADS = 64
"""Threads of a block, which are few because a run takes many registers."""
_LOG_BYTES = 2**31
"""Size of the logs of all runs that go at a time [B]."""


class Cuda(Device):
    """A GPU, as `laticauda.swim_many` finds it."""

    def march_many(
        self,
        runs: Sequence[Run],
        duration: float,
        sample_interval: float,
        use: Callable[[Block], Result],
        **how: Any,
    ) -> Iterator[Result]:
        """See `Device`; threads of the processor make no difference to it, and it logs no joints.

        Raises:
            ValueError: If there is no GPU that it can use.
        """
        if not cuda.is_available():
            raise BadArgument(
                "device", "must be `cpu` on a machine without a CUDA GPU and its driver, got 'cuda'"
            )
        n_intervals = max(1, round(duration / sample_interval))
        bytes_of_log = 8 * PATH_ROWS * (n_intervals + 1)
        n_at_a_time = max(_THREADS, _LOG_BYTES // bytes_of_log)
        for kind in kinds_of(runs, duration / n_intervals):
            for first in range(0, len(kind), n_at_a_time):
                index = np.array(kind[first : first + n_at_a_time])
                runs_of_kind = [runs[int(i)] for i in index]
                yield use(_march(runs_of_kind, index, duration, n_intervals))


def _march(runs: Sequence[Run], index: np.ndarray, duration: float, n_intervals: int) -> Block:
    """Runs of one kind, one thread each."""
    plant = runs[0].plant
    plant.flow.refuse_tables("a GPU")
    every = plant.steps_in(duration / n_intervals)
    dt = duration / n_intervals / every
    n, first_strip, first_plate, law, tail_link, has_extras = cast(Any, plant.layout.chain)
    columns = columns_of(runs)
    is_still = all(np.all(columns[row] == value) for row, value in rows.STILL_WATER)
    states = cuda.to_device(columns)
    log = cuda.device_array((n_intervals + 1, PATH_ROWS, len(runs)))
    march = kernel_of(plant, is_still)
    # Behind the laws of the joints: which are free. A kernel on a GPU cannot make arrays.
    laws = np.concatenate((law, law >= rows.FIRST_FREE))
    n_blocks = math.ceil(len(runs) / _THREADS)
    march[n_blocks, _THREADS](
        states,
        n,
        cuda.to_device(first_strip),
        cuda.to_device(first_plate),
        cuda.to_device(laws),
        tail_link,
        has_extras,
        plant.is_implicit,
        n_intervals * every,
        dt,
        every,
        log,
    )
    end = states.copy_to_host()
    path = log.copy_to_host()
    n_samples = end[rows.SAMPLES].astype(int)
    # The times of all are those of the run that went on longest: a run that diverges stops there.
    path[:, 0, 0] = path[:, 0, np.argmax(n_samples)]
    return block_of(index, path, end, n_samples)


def kernel_of(plant: PlanarPlant, is_still: bool) -> Any:
    """Return the kernel that runs a plant, one thread per run; it is compiled on first call.

    Args:
        plant: Robot and environment.
        is_still: Whether the water is that of `rows.STILL_WATER` in all runs.
    """
    run_name = RUN
    target = _target()
    if is_still and plant.run_name == RUN_PRESCRIBED:
        run_name = RUN_PRESCRIBED
        target = _target_of_prescribed()
    stepping = specialize(1, plant.law, plant.joints, plant.flow.kinds, target)
    return _kernel(getattr(stepping, run_name))


@functools.cache
def _kernel(run: Any) -> Any:
    """The kernel that runs the functions of a GPU `run`, one thread per column of `flat` and of `log`."""

    @cuda.jit
    @no_type_check
    def march(
        flat,
        n,
        first_strip,
        first_plate,
        law,
        tail_link,
        has_extras,
        implicit,
        steps,
        dt,
        every,
        log,
    ):
        i = cuda.grid(1)
        if i < flat.shape[1]:
            column = flat[:, i]
            log_of_run = log[:, :, i]
            run(
                column,
                n,
                first_strip,
                first_plate,
                law,
                tail_link,
                has_extras,
                implicit,
                steps,
                dt,
                every,
                log_of_run,
            )

    return march


@functools.cache
def _target() -> Target:
    """How the templates become functions of the GPU: every number is one float, and rows are columns."""
    device = cuda.jit(device=True)

    itself: Any = device(lambda x: x)
    where: Any = device(lambda condition, a, b: a if condition else b)
    magnitude: Any = device(lambda x: -x if x < 0.0 else x)
    always: Any = "always"

    @cuda.jit(device=True, inline=always)  # no function of a GPU may return a part of an array
    @no_type_check
    def free_joints(law):
        return law[law.size // 2 :]

    return Target(
        kernel=device,
        entry=device,
        in_lanes=lambda function: function,
        formulas={
            **{scalars.where: where, scalars.magnitude: magnitude, scalars.first_lane: itself},
            scalars.tanh: device(lambda x: math.tanh(x)),
        },
        replacements={
            **dict.fromkeys(("rows_of", "any_lane", "first_lane", "uncounted"), itself),
            "keep_until_here": device(lambda array: None),
            "where": where,
            "magnitude": magnitude,
            "differs": device(lambda x, number: x != number),
            "sincos": device(lambda x: (math.sin(x), math.cos(x))),
            "expm1": device(lambda x: math.expm1(x)),
            "free_joints": free_joints,
        },
    )


@functools.cache
def _target_of_prescribed() -> Target:
    """Return the target for `stepping.run_prescribed` in still water.

    Without the march for other water, and without CUDA's sin and cos, a thread takes 88 B of the stack
    instead of 232.
    """
    target = _target()
    device = cuda.jit(device=True)
    in_still_water = {"sincos": device(_sincos), "is_still": device(lambda numbers: True)}
    return replace(target, replacements={**target.replacements, **in_still_water}, functions={})


def _sincos(x: float) -> tuple[float, float]:
    """Return sin and cos as `laticauda.compiling.functions.sincos` does; CUDA's have a table on the stack."""
    q = math.floor(x * TWO_PER_PI + 0.5)
    y = x - q * HALF_PI
    y = y - q * HALF_PI_REST
    y = y - q * HALF_PI_REST_OF_REST
    z = y * y
    polynomial_s, polynomial_c = SINE[0], COSINE[0]
    for k in range(1, len(SINE)):
        polynomial_s = polynomial_s * z + SINE[k]
        polynomial_c = polynomial_c * z + COSINE[k]
    s = y + y * z * polynomial_s
    c = 1.0 - 0.5 * z + z * z * polynomial_c
    quadrant = int(q) & 3
    sine, cosine = (c, s) if quadrant & 1 else (s, c)
    if quadrant & 2:
        sine = -sine
    if quadrant == 1 or quadrant == 2:
        cosine = -cosine
    return sine, cosine
