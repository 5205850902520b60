"""The client in C, compiled by the compiler that is here, against the numbers of Python."""

import shutil
import subprocess

import pytest

import laticauda as lc
from laticauda.connect import Server, clients_folder
from laticauda.models.simulate import build_plant
from laticauda.motion.gaits.gait import FIRST_GAIT
from laticauda.scenarios.interfaces import Command, Start

COMPILER = shutil.which("cc") or shutil.which("gcc")


@pytest.fixture(scope="module")
def example(tmp_path_factory):
    if COMPILER is None:
        pytest.skip("there is no C compiler (cc)")
    program, folder = tmp_path_factory.mktemp("c") / "example", clients_folder() / "c"
    sources = [str(folder / name) for name in ("example.c", "laticauda_client.c")]
    strict = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Wconversion", "-Werror"]
    done = subprocess.run(
        [COMPILER, *strict, *sources, "-lm", "-o", str(program)], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return program


def run(example, *words):
    return subprocess.run([str(example), *words], capture_output=True, text=True, timeout=120)


def test_c_steps_the_robot_as_python_does_and_hears_why_it_is_refused(example, server):
    body = build_plant(lc.load_robot("mamba"), lc.load_water("paper-lateral"))
    state = body.init(Start(), Command(gait=FIRST_GAIT))
    for _ in range(40):
        state = body.step(state, Command(gait=FIRST_GAIT, offset=0.1), 0.05)
    seen = body.observe(state)
    (x, y), last = seen.center_of_mass, seen.joint_angle[-1]
    done = run(example, "127.0.0.1", str(server.port))
    assert done.stdout == f"2.000 s: {x:.9f} m, {y:.9f} m, 8 joints, the last at {last:.9f} rad\n"
    assert done.stderr == "`duration` must be > 0 s, got -1.\n"
    assert done.returncode == 0


def test_c_shows_the_token_and_says_where_nobody_listens(example, server):
    with Server("0.0.0.0", 0) as public:
        port = str(public.port)
        assert run(example, "127.0.0.1", port, public.access.token).stdout.startswith("2.000 s: ")
        done = run(example, "127.0.0.1", port)
        assert (done.returncode, done.stdout) == (1, "")
        assert done.stderr.startswith("The first message must hold the `token`")
    done = run(example, "127.0.0.1", port)
    assert (done.returncode, done.stderr) == (
        1,
        "No server listens there: start one with `laticauda serve`.\n",
    )
