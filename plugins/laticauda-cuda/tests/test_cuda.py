"""The kernels on a GPU: the real one where there is one, else numba-cuda's simulator, thread by thread in Python."""

import os
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest

import laticauda as lc
from laticauda.robot import load_robot

GAITS = [
    lc.eel_like(amplitude=a, frequency=2.0, phase_shift=0.7, offset=0.1) for a in (0.3, 0.5, 0.6)
]
SLICE = textwrap.dedent(
    """
    from dataclasses import replace
    import numpy as np
    import laticauda as lc
    import laticauda_cuda
    from laticauda.scenarios import limit_case

    body = lc.load_robot("mamba-fin").planar()
    robot = replace(body, modules=body.modules[:3], joints=body.joints[:2])
    gaits = [lc.eel_like(amplitude=a, frequency=2.0, phase_shift=0.7, offset=0.1) for a in (0.3, 0.5, 0.6)]
    calm = lc.load_water("paper-eel")
    waters = [replace(calm, normal_drag=1e7), calm, calm]  # the first one diverges
    for joints, duration in (("prescribed", 0.3), ("servo", 0.01)):
        settings = {"joints": joints, "environments": waters, "dt": 0.05 if joints == "prescribed" else 0.002}
        with limit_case():
            on_cpu, on_gpu = (lc.swim_many(robot, gaits, duration, device=d, **settings) for d in ("cpu", "cuda"))
        assert on_cpu.succeeded.tolist() == [False, True, True]
        for name in ("forward_velocity", "net_power", "mean_power", "heading", "center_of_mass"):
            np.testing.assert_allclose(getattr(on_gpu, name), getattr(on_cpu, name), rtol=1e-9, err_msg=name)
        assert on_gpu.status == on_cpu.status
    broad = replace(body.caudal_fin, length=0.06, height=0.2, opening_length=0.0)
    finned = replace(robot, caudal_fin=broad)
    spanned = replace(calm, added_mass_form="kirchhoff", trailing_edge="finite-span", edge_clip=0.2)
    on_cpu, on_gpu = (
        lc.swim_many(finned, gaits, 0.3, environments=spanned, dt=0.05, device=d) for d in ("cpu", "cuda")
    )
    np.testing.assert_allclose(on_gpu.center_of_mass, on_cpu.center_of_mass, rtol=1e-9)
    # What has a kernel of its own: no fin, still water; and with a current, the general one again.
    bare = replace(robot, caudal_fin=None)
    for water in (calm, replace(calm, current=(0.1, 0.05))):
        on_cpu, on_gpu = (
            lc.swim_many(bare, gaits, 0.3, environments=water, device=d) for d in ("cpu", "cuda")
        )
        for name in ("net_power", "heading", "center_of_mass"):
            np.testing.assert_allclose(getattr(on_gpu, name), getattr(on_cpu, name), rtol=1e-9, err_msg=name)
    from laticauda.water.fluid.gridded import Gridded
    from laticauda.water.fluid.gridded import to_dataset
    lake = to_dataset(lc.load_current("vortex"), x=[-5.0, 5.0], y=[-5.0, 5.0])
    try:
        lc.swim_many(robot, gaits[:1], 0.1, environments=[replace(calm, current=Gridded(source=lake))], device="cuda")
    except ValueError as error:
        assert "`current` must not be a gridded flow" in str(error)
    else:
        raise AssertionError("a GPU took a table")
    """
)


def test_the_simulated_gpu_gives_what_the_processor_gives():
    pytest.importorskip("numba_cuda", reason="numba-cuda is not installed")
    path = os.pathsep.join(
        [str(Path(__file__).parents[1] / "src"), os.environ.get("PYTHONPATH", "")]
    )
    environment = {**os.environ, "NUMBA_ENABLE_CUDASIM": "1", "PYTHONPATH": path}
    process = subprocess.run(
        [sys.executable, "-c", SLICE], env=environment, capture_output=True, text=True
    )
    assert process.returncode == 0, process.stderr


def gpu_or_skip():
    pytest.importorskip("numba_cuda", reason="numba-cuda is not installed")
    from numba import cuda

    if not cuda.is_available():
        pytest.skip("there is no CUDA GPU here")


@pytest.mark.parametrize("joints", ["prescribed", "pd", "servo"])
def test_a_gpu_gives_what_the_processor_gives(joints):
    gpu_or_skip()
    on_cpu, on_gpu = (
        lc.swim_many(load_robot("mamba-fin"), GAITS, 15.0, joints=joints, device=d)
        for d in ("cpu", "cuda")
    )
    for name in (
        "forward_velocity",
        "steady_velocity",
        "net_power",
        "mean_power",
        "heading",
        "center_of_mass",
    ):
        np.testing.assert_allclose(getattr(on_gpu, name), getattr(on_cpu, name), rtol=1e-9)


def test_a_machine_without_a_gpu_or_numba_cuda_says_so():
    try:
        gpu_or_skip()
    except pytest.skip.Exception:
        with pytest.raises((ValueError, ImportError), match=r"without a CUDA GPU|numba_cuda"):
            lc.swim_many(load_robot("mamba"), GAITS, 1.0, device="cuda")
