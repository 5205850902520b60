import numpy as np
import pytest

from laticauda.actuation import Prescribed
from laticauda.cosim.fmu.entry import object_code
from laticauda.fluid.laws import FunctionDrag, PolynomialDrag


def test_the_machine_code_is_kept_for_the_next_time(monkeypatch):
    first = object_code(PolynomialDrag(), Prescribed())
    monkeypatch.setattr("laticauda.cosim.fmu.entry._compiled", lambda *laws: pytest.fail("it was compiled again"))
    assert object_code(PolynomialDrag(), Prescribed()) == first
    assert first.startswith(b"\x7fELF")
    assert b"laticauda_move" in first


def test_another_processor_is_refused(monkeypatch):
    monkeypatch.setattr("platform.machine", lambda: "riscv64")
    with pytest.raises(
        ValueError, match=r"`fmu` must be made on Linux on an x86-64 processor, .* got linux on riscv64"
    ):
        object_code(PolynomialDrag(), Prescribed())


def test_a_law_that_needs_memory_of_its_own_is_refused():
    def law(v_t, v_n, across, rate, element):
        loads = np.zeros(3)
        loads[0] = -element.c_t * v_t
        return loads[0], loads[1], loads[2]

    with pytest.raises(
        ValueError,
        match=r"a drag law must be plain arithmetic, which needs no Python; `law` is not: No implementation .*zeros",
    ):
        object_code(FunctionDrag(function=law), Prescribed())
