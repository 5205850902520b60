import subprocess
import sys
import textwrap

import numpy as np
import pytest

import laticauda as lc
from laticauda.compiling import fingerprint
from laticauda.compiling.templates import is_kept
from laticauda.models.planar.model import specialize
from laticauda.robot import load_robot
from laticauda.values import scalars
from laticauda.water.fluid.laws import FunctionDrag

# The least of the kernels is enough: accelerations of the chain as it passes a state, and no march.
SCRIPT = textwrap.dedent(
    """
    import sys
    from dataclasses import replace
    import numpy as np
    import laticauda as lc
    from laticauda.compiling.templates import is_kept
    from laticauda.water.fluid.laws import FunctionDrag
    from laticauda.models.planar import rows
    sys.path.insert(0, {folder!r})
    from {module} import make_law
    water = replace(lc.load_water("paper-lateral"), drag=FunctionDrag(function=make_law(1.0)))
    plant = lc.build_plant(lc.load_robot("mamba"), water)
    print(is_kept(plant.kernels_of(1).evaluate))
    command = lc.Command(gait=lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7))
    S, a = plant.rows(plant.init(lc.Start(velocity=0.5), command), command), plant.layout
    free = np.zeros(a.n_bodies, dtype=bool)
    plant.kernels_of(1).evaluate(S, a.n_bodies, a.first_strip, a.first_plate, free, a.tail_link, a.has_extras)
    print(repr(float(S[rows.AX])))
    """
)
LAW = textwrap.dedent(
    """
    def power(x, exponent):
        return {factor} * (x * x) ** (0.5 * exponent)

    def make_law(exponent):
        def law(v_t, v_n, across, rate, element):
            f_t, f_n = -element.c_t * v_t * power(v_t, exponent), -element.c_n * v_n * power(v_n, exponent)
            return f_t, f_n, -element.lambda_2 * rate
        return law
    """
)


def test_the_digest_of_a_law_sees_its_code_its_constants_and_what_it_calls():
    def make(exponent, scale=1.0):
        def law(v_t, v_n, rate, *_):
            return -(abs(v_t) ** exponent) * scale, scalars.magnitude(v_n), rate

        return law

    def other(v_t, v_n, rate, *_):
        return -v_t, -v_n, -rate

    assert fingerprint(make(1.0)) == fingerprint(make(1.0))
    prints = [fingerprint(law) for law in (make(1.0), make(2.0), make(1.0, 2.0), other)]
    assert len(set(prints)) == 4


def test_the_digest_of_a_law_does_not_see_what_only_bears_the_name_of_one_of_its_attributes():
    names = {}
    exec("def law(self, v):\n    return -scale * self.exponent * v", names)
    prints = []
    for scale, exponent in ((1.0, 1.0), (1.0, 2.0), (2.0, 2.0)):
        names.update(scale=scale, exponent=exponent)
        prints.append(fingerprint(names["law"]))
    assert prints[0] == prints[1] != prints[2]


def test_the_digest_of_a_law_sees_the_code_of_functions_inside_it():
    def make(power):
        names = {}
        exec(f"def law(v):\n    return [x**{power} for x in (v,)][0]", names)
        return names["law"]

    assert fingerprint(make(2)) == fingerprint(make(2)) != fingerprint(make(3))


def test_another_drag_law_takes_the_drives_as_they_are():
    def law(v_t, v_n, across, rate, element):
        return -element.c_t * v_t, -element.c_n * v_n, -element.lambda_2 * rate

    usual, other = specialize(), specialize(law=FunctionDrag(function=law))
    assert usual is not other
    assert usual.drives.set_reference is other.drives.set_reference
    assert usual.recursion.accelerations is not other.recursion.accelerations


def test_a_law_of_ones_own_compiles_once_is_found_again_wherever_it_stands_and_compiles_anew_when_edited(
    tmp_path,
):
    def run(module="mylaw"):
        done = subprocess.run(
            [sys.executable, "-c", SCRIPT.format(folder=str(tmp_path), module=module)],
            capture_output=True,
            text=True,
            check=True,
        )
        kept, acceleration = done.stdout.split()
        return kept == "True", float(acceleration)

    file = tmp_path / "mylaw.py"
    factor = 1.0 + np.random.default_rng().random()  # never compiled before on this machine
    file.write_text(LAW.format(factor=factor))
    first = run()
    assert not first[0]
    file = file.rename(tmp_path / "elsewhere.py")
    assert run("elsewhere") == (True, first[1])
    file.write_text(LAW.format(factor=3.0 * factor))  # an edit in a function that the law calls
    edited = run("elsewhere")
    assert not edited[0]
    assert edited[1] != pytest.approx(first[1], rel=1e-2)


def test_the_built_in_law_is_compiled_once_it_has_run():
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
    lc.swim(load_robot("mamba"), gait, duration=1.0)
    assert is_kept(specialize().run_prescribed)
