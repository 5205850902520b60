import subprocess
import sys
import textwrap

import numpy as np
import pytest

import laticauda as lc
from laticauda import scalars
from laticauda.compiling import fingerprint
from laticauda.planar.specialize import is_compiled
from laticauda.robot import load_robot

SCRIPT = textwrap.dedent(
    """
    import sys
    from dataclasses import replace
    import laticauda as lc
    from laticauda.fluid.laws import FunctionDrag
    from laticauda.planar.specialize import is_compiled
    sys.path.insert(0, {folder!r})
    from mylaw import make_law
    law = FunctionDrag(function=make_law({exponent}))
    print(is_compiled(law=law))
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
    water = replace(lc.load_water("paper-lateral"), drag=law)
    print(repr(lc.swim(lc.load_robot("mamba"), gait, duration=5.0, environment=water).forward_velocity))
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


def test_a_law_of_ones_own_compiles_once_is_found_again_and_compiles_anew_when_edited(tmp_path):
    def run(exponent=1.0):
        done = subprocess.run(
            [sys.executable, "-c", SCRIPT.format(folder=str(tmp_path), exponent=exponent)],
            capture_output=True,
            text=True,
            check=True,
        )
        compiled, speed = done.stdout.split()
        return compiled == "True", float(speed)

    file = tmp_path / "mylaw.py"
    factor = 1.0 + np.random.default_rng().random()  # never compiled before on this machine
    file.write_text(LAW.format(factor=factor))
    first = run()
    assert not first[0]
    assert run() == (True, first[1])
    file.write_text(LAW.format(factor=3.0 * factor))  # an edit in a function that the law calls
    edited = run()
    assert not edited[0]
    assert edited[1] != pytest.approx(first[1], rel=1e-2)


def test_the_built_in_law_is_compiled_once_it_has_run():
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
    lc.swim(load_robot("mamba"), gait, duration=1.0)
    assert is_compiled()
