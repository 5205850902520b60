from dataclasses import replace

import laticauda as lc
from laticauda.values import make_quickly

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)


def test_a_value_made_quickly_is_that_of_its_constructor():
    command = make_quickly(lc.Command, gait=GAIT, offset=0.1)
    assert command == lc.Command(gait=GAIT, offset=0.1)
    assert repr(command) == repr(lc.Command(gait=GAIT, offset=0.1))
    assert replace(command, offset=0.2) == lc.Command(gait=GAIT, offset=0.2)
