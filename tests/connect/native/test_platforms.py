import importlib.util
import json
import shutil
import subprocess
from typing import Any

import numpy as np
import pytest

import laticauda as lc
from laticauda.connect.native import entry, platforms
from laticauda.connect.native.linking import LinkingFailed, link_library
from laticauda.connect.native.machine_code import compile_kernels, find_cache_path
from laticauda.connect.native.platforms import PLATFORMS, find_platform
from laticauda.connect.native.tables import build_tables
from laticauda.models.planar.layout import flow_rows
from laticauda.motion.joints import Prescribed
from laticauda.values.errors import MissingExtra
from laticauda.water.fluid.laws import FunctionDrag, PolynomialDrag

needs_zig = pytest.mark.skipif(
    importlib.util.find_spec("ziglang") is None, reason="ziglang is not installed"
)
# How files begin: of machine code, and of what is linked of it.
ELF, COFF, MACHO, WASM, PE = (
    b"\x7fELF\x02\x01",
    b"\x64\x86",
    b"\xcf\xfa\xed\xfe",
    b"\0asm\1\0\0\0",
    b"MZ",
)
X86_64, AARCH64 = (62).to_bytes(2, "little"), (183).to_bytes(2, "little")  # in the header of ELF


def code_for(name: str) -> bytes:
    return compile_kernels(PolynomialDrag(), Prescribed(), (), PLATFORMS[name])


def test_the_machine_code_is_kept_for_the_next_time(monkeypatch):
    first = code_for("linux64")
    monkeypatch.setattr(
        "laticauda.connect.native.machine_code.compile_bitcode",
        lambda *laws: pytest.fail("it was compiled again"),
    )
    assert code_for("linux64") == first
    assert b"laticauda_move" in first


@pytest.mark.parametrize(
    ("name", "beginning", "family"),
    [
        ("linux64", ELF, X86_64),
        ("aarch64", ELF, AARCH64),
        ("win64", COFF, None),
        ("darwin-arm64", MACHO + b"\x0c\0\0\1", None),
        ("darwin-x86-64", MACHO + b"\x07\0\0\1", None),
        ("wasm32", WASM, None),
    ],
)
def test_any_machine_writes_the_machine_code_of_every_platform(name, beginning, family):
    code = code_for(name)
    assert code.startswith(beginning)
    assert family is None or code[18:20] == family


def test_no_two_platforms_share_a_name_on_disk():
    kept = {find_cache_path(PolynomialDrag(), Prescribed(), (), f"{name}.o") for name in PLATFORMS}
    assert len(kept) == len(PLATFORMS) == 6


def test_a_water_that_is_not_the_papers_needs_no_new_machine_code():
    code_for("linux64")
    water = lc.Water(tangential_friction=0.1, normal_drag=1.0, added_mass=1.0)
    assert find_cache_path(water.drag, Prescribed(), flow_rows(water).kinds, "linux64.o").exists()


@needs_zig
def test_a_library_for_a_mac_is_linked_on_any_machine(tmp_path):
    # Something that is offered has to need the kernels: of an object that nobody needs, Zig's
    # linker for macOS dies.
    text = """
#include "one.h"
extern long laticauda_move(void);
__attribute__((visibility("default"))) long one(void) { return ONE + laticauda_move(); }
"""
    (tmp_path / "one.c").write_text(text)
    code = link_library(
        code_for("darwin-arm64"),
        PLATFORMS["darwin-arm64"],
        [tmp_path / "one.c"],
        {"one.h": "#define ONE 1"},
    )
    assert code.startswith(MACHO + b"\x0c\0\0\1")
    assert code[12] == 6  # a dynamic library


SWIM = """
import fs from 'node:fs';
const told = JSON.parse(fs.readFileSync(process.argv[3]));
const module = new WebAssembly.Module(fs.readFileSync(process.argv[2]));
const {memory, _initialize, laticauda_reserve, laticauda_move} = new WebAssembly.Instance(module, {}).exports;
_initialize();
function place(kind, numbers) {
  const at = laticauda_reserve(8 * numbers.length);
  new kind(memory.buffer, at, numbers.length).set(numbers);
  return at;
}
const tables = [place(BigInt64Array, told.whole.map(BigInt)), place(Float64Array, told.real)];
const variables = place(Float64Array, told.variables);
const rows = place(Float64Array, new Array(told.n_rows).fill(0));
const all = [];
for (let k = 0; k <= told.steps; k++) {
  if (laticauda_move(...tables, variables, rows, k === 0 ? 0 : 0.05) !== 1n) throw new Error('it diverged');
  all.push([...new Float64Array(memory.buffer, variables, told.variables.length)]);
}
console.log(JSON.stringify({imports: WebAssembly.Module.imports(module).length, all}));
"""


@needs_zig
@pytest.mark.skipif(shutil.which("node") is None, reason="node is not installed")
def test_a_browser_needs_nothing_but_the_module_and_swims_as_python_does(tmp_path):
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
    body: Any = lc.build_plant(lc.load_robot("mamba"), lc.load_water("paper-lateral"))
    tables = build_tables(body, gait, lc.Start(), inputs="gait")
    module = link_library(code_for("wasm32"), PLATFORMS["wasm32"])
    assert len(module) < 200_000
    told = {
        "whole": tables.whole.tolist(),
        "real": tables.real.tolist(),
        "variables": [one.start for one in tables.variables],
        "n_rows": tables.n_rows + entry.SCRATCH,
        "steps": 600,
    }
    (tmp_path / "kernels.wasm").write_bytes(module)
    (tmp_path / "told.json").write_text(json.dumps(told))
    (tmp_path / "swim.mjs").write_text(SWIM)
    command = ["node", "swim.mjs", "kernels.wasm", "told.json"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    found = json.loads(done.stdout)
    assert found["imports"] == 0
    number = {one.name: i for i, one in enumerate(tables.variables)}
    seen = np.array(found["all"])[:, [number["center_of_mass.x"], number["center_of_mass.y"]]]
    trial = lc.swim("mamba", gait, 30.0, sample_interval=0.05)
    assert seen == pytest.approx(trial.center_of_mass, abs=1e-12)


def test_an_unknown_machine_has_to_choose_a_platform(monkeypatch):
    monkeypatch.setattr(platforms, "machine", lambda: "riscv64")
    with pytest.raises(
        ValueError, match=r"`platform` must be given on \w+ on riscv64, which is none of them"
    ):
        find_platform()
    assert find_platform("win64").pair == "x86_64-windows"
    assert [one.name for one in platforms.find_library_platforms(("darwin", "linux64"))] == [
        *("linux64", "darwin-arm64", "darwin-x86-64")
    ]
    with pytest.raises(ValueError, match=r"`platform` must be one of `linux64`, .* got 'win32'"):
        find_platform("win32")


@pytest.mark.parametrize(
    ("system", "machine", "name"),
    [
        ("linux", "x86_64", "linux64"),
        ("win32", "AMD64", "win64"),
        ("darwin", "arm64", "darwin-arm64"),
    ],
)
def test_this_machine_is_known_by_what_python_says_of_it(monkeypatch, system, machine, name):
    monkeypatch.setattr("sys.platform", system)
    monkeypatch.setattr(platforms, "machine", lambda: machine)
    assert find_platform().name == name


def test_without_zig_another_platform_says_what_to_install(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(platforms, "current_platform", lambda: PLATFORMS["linux64"])
    with pytest.raises(
        MissingExtra, match=r'x86_64-windows needs ziglang; run `pip install .*\[export\]"`'
    ):
        link_library(b"", PLATFORMS["win64"])


def test_what_cannot_be_linked_says_what_the_compiler_said(tmp_path):
    (tmp_path / "wrong.c").write_text("this is no C\n")
    with pytest.raises(LinkingFailed, match=r"(?s)cannot make a library for .* It says:.*wrong.c"):
        link_library(code_for(find_platform().name), find_platform(), [tmp_path / "wrong.c"])


def test_a_law_that_needs_memory_of_its_own_is_refused():
    def law(v_t, v_n, across, rate, element):
        loads = np.zeros(3)
        loads[0] = -element.c_t * v_t
        return loads[0], loads[1], loads[2]

    with pytest.raises(
        ValueError,
        match=r"a drag law must be plain arithmetic, which needs no Python; `law` is not: No implementation .*zeros",
    ):
        compile_kernels(FunctionDrag(function=law), Prescribed(), (), find_platform())
