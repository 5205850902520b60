"""A law of each kind in a module outside the package, driven through everything that knows laws."""

import importlib.util
import sys
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.actuation import JointLaw
from laticauda.codec import decode, encode
from laticauda.cosim.fmu.exporting import export_fmu
from laticauda.fluid import DragLaw
from laticauda.gaits import Envelope, Gait
from laticauda.robot import Water, from_toml, to_toml
from laticauda.scenarios import scenario
from laticauda.simulate import parameters, sensitivities

pytestmark = pytest.mark.slow

# The laws of the docs, letter by letter: the kernels are compiled for a formula once, whoever holds it.
MODULE = '''
from laticauda.actuation import JointLaw
from laticauda.fluid import DragLaw
from laticauda.gaits import Envelope
from laticauda.quantities import quantity, value
from laticauda.scalars import magnitude


@value
class Carangiform(Envelope):
    """A stiff head, and a wave in the rest."""

    share: float = quantity("", "Of the body that is stiff", ge=0.0, le=1.0, default=0.25)

    def __call__(self, i, n):
        return max(0.0, 1.0 - i / n - self.share)


@value
class WashedDrag(DragLaw):
    """Drag along that sees the sideways speed, drag across that sees the speed ahead."""

    wash: float = quantity("", "Share of the sideways speed that the drag along sees", ge=0.0, default=0.2)
    floor: float = quantity("m/s", "Speed below which drag is linear", ge=0.0, default=0.1)

    def __call__(self, v_t, v_n, across, rate, element):
        f_t = -element.c_t * v_t * (self.floor + magnitude(v_t) + self.wash * across)
        f_n = -element.c_n * v_n * (self.floor + magnitude(v_n))
        return f_t, f_n, -element.lambda_3 * magnitude(rate) * rate


@value
class Spring(JointLaw):
    """A spring to the reference, and a damper to its rate."""

    stiffness: float = quantity("N m/rad", "k", gt=0.0, default=30.0)
    damping: float = quantity("N m s/rad", "d", ge=0.0, default=3.0)

    def __call__(self, angle, rate, reference, reference_rate, reference_acceleration, drive):
        torque = self.stiffness * (reference - angle) + self.damping * (reference_rate - rate)
        return torque, self.stiffness, self.damping
'''
GROUPS = ((Envelope, "carangiform"), (DragLaw, "washed-drag"), (JointLaw, "spring"))
ROBOT, STILL = lc.load_robot("mamba"), lc.load_water("paper-lateral")


@pytest.fixture(scope="module")
def ideas(tmp_path_factory):
    file = tmp_path_factory.mktemp("elsewhere") / "ideas.py"
    file.write_text(MODULE)
    spec = importlib.util.spec_from_file_location("ideas", file)
    module = importlib.util.module_from_spec(spec)
    sys.modules["ideas"] = module
    spec.loader.exec_module(module)
    yield module
    for group, name in GROUPS:
        del group._known[name]
    del sys.modules["ideas"]


@pytest.fixture(scope="module")
def gait(ideas):
    return Gait(envelope=ideas.Carangiform(share=0.2), amplitude=0.5, frequency=2.0, phase_shift=0.7)


@pytest.fixture(scope="module")
def water(ideas):
    return replace(STILL, drag=ideas.WashedDrag(wash=0.3, floor=0.5))


def test_each_is_known_by_its_name_and_goes_through_files(ideas, gait, water):
    for group, name in GROUPS:
        assert name in group.names()
    assert gait.kind == "carangiform"
    assert decode(Gait, encode(gait)) == gait
    assert from_toml(to_toml(water), Water) == water


def test_they_swim_and_their_numbers_count(ideas, gait, water):
    how = {"duration": 3.0, "joints": ideas.Spring(), "environment": water}
    usual = lc.swim(ROBOT, gait, **how)
    assert usual.succeeded
    assert usual.settings["joints"] == "spring"
    changes = [
        how | {"joints": ideas.Spring(stiffness=10.0)},
        how | {"environment": replace(water, drag=ideas.WashedDrag(wash=0.6, floor=0.5))},
        how | {"environment": replace(water, drag=ideas.WashedDrag(wash=0.3, floor=0.2))},
    ]
    speeds = [lc.swim(ROBOT, gait, **one).forward_velocity for one in changes]
    speeds.append(lc.swim(ROBOT, replace(gait, envelope=ideas.Carangiform(share=0.5)), **how).forward_velocity)
    assert all(abs(speed / usual.forward_velocity - 1.0) > 1e-3 for speed in speeds)


def test_a_batch_of_other_numbers_is_bit_for_bit_that_of_single_runs(ideas, gait, water):
    laws = [ideas.WashedDrag(wash=0.1 * i, floor=0.3) for i in range(5)]
    waters = [replace(water, drag=law) for law in laws]
    how = {"joints": ideas.Spring(stiffness=25.0)}
    swims = lc.swim_many(ROBOT, gait, 2.0, environments=waters, **how)
    singles = [lc.swim(ROBOT, gait, 2.0, environment=one, **how) for one in waters]
    np.testing.assert_array_equal(swims.forward_velocity, [one.forward_velocity for one in singles])


def test_the_model_in_space_agrees_with_that_in_the_plane(ideas, gait, water):
    pytest.importorskip("mujoco")
    how = {"environment": water, "joints": ideas.Spring(), "dt": 0.001}
    planar = lc.swim(ROBOT, gait, 2.0, **how)
    spatial = lc.swim(ROBOT, gait, 2.0, model="spatial", root="planar", **how)
    length = np.linalg.norm(planar.center_of_mass[-1])
    np.testing.assert_allclose(spatial.center_of_mass[:, :2], planar.center_of_mass, atol=1e-3 * length)


def test_sweeps_know_their_numbers(ideas, gait, water):
    known = parameters(scenario(ROBOT, gait, 2.0, environment=water, joints=ideas.Spring()))
    assert {"water.drag.wash", "water.drag.floor", "gait.envelope.share"} <= known.keys()
    assert known["water.drag.floor"].unit == "m/s"


def test_the_derivatives_to_their_numbers_are_those_of_differences(ideas, gait, water):
    how = {"joints": ideas.Spring(), "dt": 0.002}
    names = ["water.drag.wash", "water.drag.floor"]
    found = sensitivities(ROBOT, gait, 2.0, environments=water, names=names, **how)
    for name in names:
        field, step = name.rsplit(".", 1)[1], 1e-5
        value = getattr(water.drag, field)
        ends = [replace(water, drag=replace(water.drag, **{field: value + s})) for s in (step, -step)]
        up, down = lc.swim_many(ROBOT, gait, 2.0, environments=ends, **how).forward_velocity
        assert found.of("forward_velocity", name)[0] == pytest.approx((up - down) / (2.0 * step), rel=1e-5)


def test_an_fmu_has_their_numbers_as_parameters(ideas, gait, water, tmp_path):
    variables = {
        v.name: v for v in export_fmu(tmp_path / "own.fmu", ROBOT, gait, environment=water, joints=ideas.Spring())
    }
    assert variables["water.drag.wash"].start == 0.3
    assert variables["water.drag.floor"].unit == "m/s"
    assert variables["water.drag.floor"].least == 0.0


def test_a_run_goes_on_with_its_laws(ideas, gait, water):
    body = lc.plant(ROBOT, water, joints=ideas.Spring(), ramp=0.0)
    whole = lc.run(body, lc.OpenLoop(command=lc.Command(gait=gait)), 2.0)
    half = lc.run(body, lc.OpenLoop(command=lc.Command(gait=gait)), 1.0)
    after = lc.resume(body, half, 1.0)
    np.testing.assert_array_equal(after.center_of_mass[-1], whole.center_of_mass[-1])


def test_a_law_that_cannot_be_compiled_says_why(ideas):
    class Broken(ideas.Spring):
        def __call__(self, angle, rate, reference, reference_rate, reference_acceleration, drive):
            return self.words, drive.nothing, 0.0

    try:
        with pytest.raises(ValueError, match=r"`Broken` must have a formula that Numba can compile: Unknown attribute"):
            lc.plant(ROBOT, STILL, joints=Broken())
    finally:
        del JointLaw._known["broken"]
