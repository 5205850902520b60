import shutil
import subprocess
import sys

import pytest
from kernels import copy_source

from laticauda.models.planar.model import TEMPLATES, specialize
from laticauda.models.spatial.twin import TEMPLATES as SPATIAL_TEMPLATES
from laticauda.values.sources import PACKAGE, closure, digest_of
from laticauda.water.fluid.flow import rows_of
from laticauda.water.fluid.laws import TotalSpeedDrag
from laticauda.water.fluid.uniform import LinearShear
from laticauda.water.fluid.waves import Waves

PLANAR = tuple(f"laticauda.models.planar.{name}" for name in TEMPLATES)
MADE_OF = [
    PLANAR,
    tuple(f"laticauda.models.spatial.{name}" for name in SPATIAL_TEMPLATES),
    ("laticauda.water.mujoco.callback",),
    ("laticauda.connect.native.machine_code",),
]
# The least of the kernels that the drag law is in, and the one that the joint laws are in.
TOW = """
import laticauda as lc
print(lc.build_plant(lc.load_robot("mamba"), lc.load_water("paper-lateral")).towing_load(0.5, 0.3)[1])
"""
SWIM = """
import laticauda as lc
gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
print(lc.swim(lc.load_robot("mamba"), gait, duration=1.0, model="spatial", joints="pd").work[-1, 0])
"""


ALIKE = """
from laticauda.compiling import compile_once_across_processes
@compile_once_across_processes
def double(x):
    return 2 * x
assert double(21) == 42
print(sum(double.stats.cache_misses.values()))
"""


@pytest.fixture
def copy(tmp_path):
    return shutil.copytree(
        PACKAGE, tmp_path / "laticauda", ignore=shutil.ignore_patterns("__pycache__")
    )


@pytest.fixture
def copy_with_machine_code(tmp_path):
    """Whose kernels are found on disk, if they have been compiled here before: what an edit must not be deceived by."""
    return shutil.copytree(
        PACKAGE,
        tmp_path / "laticauda",
        ignore=shutil.ignore_patterns("*.pyc", "*.o"),
        copy_function=copy_source,
    )


@pytest.mark.parametrize("modules", MADE_OF, ids=lambda modules: modules[-1])
def test_an_edit_of_any_file_that_a_kernel_is_made_of_changes_its_digest(copy, modules):
    before = digest_of(*modules, package=copy)
    assert before == digest_of(*modules)
    for path in closure(*modules, package=copy):
        text = path.read_text()
        path.write_text(text + "# an edit\n")
        assert digest_of(*modules, package=copy) != before, path
        path.write_text(text)
    assert digest_of(*modules, package=copy) == before


@pytest.mark.parametrize("modules", MADE_OF, ids=lambda modules: modules[-1])
def test_kernels_are_made_of_the_laws_and_of_the_compiler_s_own_sources_too(modules):
    found = {str(path.relative_to(PACKAGE)) for path in closure(*modules)}
    assert found >= {"values/scalars.py", "compiling/__init__.py", "compiling/lanes.py"}


def test_specializations_have_in_common_what_does_not_know_how_they_differ():
    """It is compiled once for both, and found on disk by processes that have the other one alone."""
    still, *moving = (
        specialize(flow=rows_of(flow).kinds) if flow else specialize()
        for flow in (None, LinearShear(speed=0.1), Waves(height=0.1, length=2.0))
    )
    one, other = (kernels.recursion for kernels in moving)
    assert one.velocities is other.velocities is still.recursion.velocities
    assert (
        one.own_bias is other.own_bias is not still.recursion.own_bias
    )  # all that moving water adds is the same
    assert one.accelerations is not other.accelerations
    assert specialize(law=TotalSpeedDrag()).recursion.own_bias is not still.recursion.own_bias
    for name in {"own_bias", "accelerations"}:
        assert vars(other)[name].py_func.__globals__["__name__"] == "laticauda.compiling.templates"


def test_an_edit_elsewhere_leaves_machine_code_valid(copy):
    before = digest_of(*PLANAR, package=copy)
    (copy / "models" / "planar" / "model.py").write_text("# gone\n")
    assert digest_of(*PLANAR, package=copy) == before


def test_what_only_type_checkers_import_does_not_count(tmp_path):
    package = tmp_path / "house"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "a.py").write_text(
        "from typing import TYPE_CHECKING\nfrom house import b\nif TYPE_CHECKING:\n    from house.c import x\n"
    )
    (package / "b.py").write_text("def later():\n    import house.d\n")
    (package / "c.py").write_text("")
    (package / "d.py").write_text("")
    assert [path.name for path in closure("house.a", package=package)] == ["a.py", "b.py", "d.py"]


def test_a_name_handed_on_by_a_package_comes_from_the_module_that_defines_it(tmp_path):
    package = tmp_path / "house"
    (package / "room").mkdir(parents=True)
    (package / "__init__.py").write_text("")
    (package / "a.py").write_text("from house.room import X, Y, c\n")
    (package / "room" / "__init__.py").write_text(
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from house.room.b import X as X\nY = 1\n"
    )
    for name in "bcd":
        (package / "room" / f"{name}.py").write_text("")
    found = {str(path.relative_to(package)) for path in closure("house.a", package=package)}
    assert found == {"a.py", "room/__init__.py", "room/b.py", "room/c.py"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("script", "file", "old", "new"),
    [
        (TOW, "water/fluid/laws.py", "f_n = -element.c_n", "f_n = -2.0 * element.c_n"),
        (
            SWIM,
            "motion/joints/laws.py",
            "k_p * (reference - angle),",
            "0.5 * k_p * (reference - angle),",
        ),
    ],
    ids=["planar", "spatial"],
)
def test_an_edited_scalar_function_changes_what_the_kernels_compute(
    copy_with_machine_code, script, file, old, new
):
    copy = copy_with_machine_code

    def number():
        run = [sys.executable, "-c", script]
        done = subprocess.run(
            run, env={"PYTHONPATH": str(copy.parent)}, capture_output=True, text=True, check=True
        )
        return float(done.stdout)

    before, text = number(), (copy / file).read_text()
    assert old in text
    (copy / file).write_text(text.replace(old, new))
    assert abs(number() / before - 1.0) > 0.01


def test_processes_that_begin_together_compile_a_function_once(tmp_path):
    (tmp_path / "alike.py").write_text(ALIKE)
    begun = [
        subprocess.Popen([sys.executable, tmp_path / "alike.py"], stdout=subprocess.PIPE)
        for _ in range(3)
    ]
    assert sorted(int(process.communicate()[0]) for process in begun) == [0, 0, 1]
