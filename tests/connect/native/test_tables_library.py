"""The plain library in C, in the program that the docs show, beside the same run in Python."""

import importlib.util
import math
import re
import shutil
import struct
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import laticauda as lc
from laticauda.connect import export_c
from laticauda.connect.native.c_library import write_header
from laticauda.connect.native.tables import build_tables_of_scenario
from laticauda.scenarios.interfaces import Command, Start

PAGE = Path(__file__).parents[3] / "docs" / "how-to" / "c-library.md"
GAIT = lc.lateral_undulation(
    amplitude=math.radians(30), frequency=math.radians(90), phase_shift=math.radians(40)
)
needs_cc = pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")


def program() -> str:
    (code,) = re.findall(
        r'^```c title="main.c"\n(.*?)^```$', PAGE.read_text(), re.MULTILINE | re.DOTALL
    )
    return code


def in_python() -> list[float]:
    water = replace(lc.load_water("paper-lateral"), normal_drag=1.5)
    body: Any = lc.build_plant(lc.load_robot("mamba-fin"), water)
    gait = replace(GAIT, amplitude=0.5)
    state = body.init(Start(), Command(gait=gait))
    for k in range(600):
        command = Command(gait=gait if k < 200 else replace(gait, offset=0.1))
        state, _, _ = body.march(state, command, 0.05, 0.05)
    seen = body.observe(state)
    return [*seen.center_of_mass, seen.heading]


def output(folder: Path, *command: str) -> list[str]:
    (folder / "main.c").write_text(program())
    subprocess.run(
        [*command, "-std=c11", "-Wall", "-Wextra", "-Werror", "-o", "main"], cwd=folder, check=True
    )
    return subprocess.run(
        ["./main"], cwd=folder, capture_output=True, text=True, check=True
    ).stdout.split()


@needs_cc
@pytest.mark.parametrize("static", [False, True])
def test_the_program_of_the_page_swims_as_python_does(tmp_path, static):
    variables = export_c(tmp_path / "snake.h", "mamba-fin", GAIT, static=static)
    linking = ["libsnake.a", "-lm"] if static else ["-L.", "-lsnake", "-Wl,-rpath,."]
    found = output(tmp_path, "cc", "main.c", *linking)
    assert [float(number) for number in found] == pytest.approx(in_python(), abs=1e-12)
    assert variables[0].name == "time"


@pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="ziglang is not installed")
def test_a_static_library_for_a_robots_own_computer_is_written_here(tmp_path):
    export_c(tmp_path / "snake.h", "mamba-fin", GAIT, static=True, platform="aarch64")
    archive = (tmp_path / "libsnake.a").read_bytes()
    assert archive.startswith(b"!<arch>\n")
    assert archive.count(b"\x7fELF") == 2  # the kernels, and what is around them
    first = archive.index(b"\x7fELF")
    assert archive[first + 18 : first + 20] == (183).to_bytes(
        2, "little"
    )  # the processor, as ELF has it
    assert b"snake_step" in archive


@pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="ziglang is not installed")
def test_one_static_library_is_for_both_kinds_of_mac(tmp_path):
    export_c(tmp_path / "snake.h", "mamba-fin", GAIT, static=True, platform="darwin")
    made = (tmp_path / "libsnake.a").read_bytes()
    assert struct.unpack(">2I", made[:8]) == (0xCAFEBABE, 2)
    for k, kind in enumerate((0x0100000C, 0x01000007)):  # ARM and x86-64, of 64 bits
        found, _, at, size, alignment = struct.unpack(">5I", made[8 + 20 * k :][:20])
        assert found == kind and at % 2**alignment == 0 and at + size <= len(made)
        assert made[at:].startswith(b"!<arch>\n")


MISUSE = """
#include <stdio.h>
#include <string.h>
#include "snake.h"
int main(void) {
    snake robot, before;
    snake_reset(&robot);
    robot.water_density = -1.0;
    puts(snake_name(snake_begin(&robot)));
    snake_reset(&robot);
    printf("%d\\n", snake_begin(&robot));
    for (int k = 0; k < 20; k++) snake_step(&robot, 0.05);
    before = robot;
    printf("%d %d %d\\n", snake_step(&robot, 0.0), snake_step(&robot, -1.0), snake_step(&robot, 1e300));
    robot.joint_angle[3] = 7.0; /* an output, which the next step sets anew */
    robot.gait_amplitude = 0.0 / 0.0;
    puts(snake_name(snake_step(&robot, 0.05)));
    robot = before;
    robot.gait_amplitude = 1e5;
    robot.dt = 1e3;
    snake there = robot;
    printf("%d ", snake_step(&robot, 1e3));
    printf("%d\\n", memcmp(&robot, &there, sizeof robot));
    robot = before;
    for (int k = 0; k < 20; k++) snake_step(&robot, 0.05);
    there = robot;
    robot = before;
    for (int k = 0; k < 20; k++) snake_step(&robot, 0.05);
    printf("%d [%s]\\n", memcmp(&robot, &there, sizeof robot), snake_name(100000));
}
"""


@needs_cc
def test_what_is_out_of_its_range_or_diverges_is_refused_by_name_and_changes_nothing(tmp_path):
    export_c(tmp_path / "snake.h", "mamba-fin", GAIT, static=True)
    (tmp_path / "main.c").write_text(MISUSE)
    subprocess.run(["cc", "main.c", "libsnake.a", "-lm", "-o", "main"], cwd=tmp_path, check=True)
    done = subprocess.run(["./main"], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == [
        "water.density",
        "0",
        "-2 -2 -2",
        "gait.amplitude",
        "-1 0",
        "0 []",
    ]


def test_the_header_names_every_variable_with_its_unit_and_range():
    tables = build_tables_of_scenario("mamba-fin", GAIT, joints="servo", inputs="references")
    header = write_header(tables, "snake")
    members = re.findall(
        r"^    double \w+(?:\[(\d+)\])?; /\* (?!of the kernels)", header, re.MULTILINE
    )
    counts = [int(count or 1) for count in members]
    assert sum(counts) == len(tables.variables)
    for line in (
        "double references[8]; /* input, rad, -100000 to 100000. Reference angle of joint i, held during a "
        "communication step. */",
        "double water_density; /* parameter, kg/m3, 1e-09 to inf. Density of the water. */",
        "double link_angle[9]; /* output, rad. Angle of link i. */",
    ):
        assert line in header


def test_a_robots_name_ends_no_comment():
    tables = build_tables_of_scenario(replace(lc.load_robot("mamba"), name="a*/b"), GAIT)
    header = write_header(tables, "snake")
    assert "The swimming snake robot a* /b" in header
    assert header.count("/*") == header.count("*/")


@pytest.mark.parametrize("hinges", [0, 2])
def test_members_of_a_fin_have_names_of_their_own(hinges):
    robot = lc.load_robot("mamba-fin")
    assert robot.caudal_fin is not None
    bending = (
        {"n_hinges": hinges, "flexural_rigidity": 0.05, "bending_damping": 0.002} if hinges else {}
    )
    fin = replace(robot.caudal_fin, **bending)
    header = write_header(build_tables_of_scenario(replace(robot, caudal_fin=fin), GAIT), "snake")
    names = re.findall(r"^    double (\w+)", header, re.MULTILINE)
    assert len(set(names)) == len(names)
    assert (("fin_angle" in header) or ("fin_angle_1" in header)) == bool(hinges)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"path": "snake.c"}, "`path` must be a file that ends in .h, got snake.c."),
        ({"platform": "wasm32"}, "`platform` must be one of `linux64`, .*got 'wasm32'."),
        ({"platform": "vax"}, "`platform` must be one of `linux64`, .*got 'vax'."),
        (
            {"environment": lc.load_ground("coulomb")},
            "`environment` must be of class Water, got Ground.",
        ),
    ],
)
def test_what_cannot_be_exported_is_refused_by_name(tmp_path, monkeypatch, settings, message):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match=message):
        export_c(**{"path": "snake.h", "robot": "mamba", "gait": GAIT} | settings)
    assert list(tmp_path.iterdir()) == []
