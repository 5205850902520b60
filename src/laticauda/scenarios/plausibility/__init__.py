"""Can this be meant? What a run is made of, judged once for everybody: files, options, Python, servers and pages.

What cannot be (water of 1 kg/m^3, a motor that gives more than it takes) is refused; of what hardly
is (a gait of 20 cycles per second) there is one warning. Either names the argument, the rule with
its unit, the value, and, if one fits, the unit that was probably meant.

doubts.py      a doubt: what is odd, and the unit that was probably meant
bodies.py      size, mass, inertia and fins of robots
motors.py      data of servos, and what is mounted on a robot
waters.py      density, coefficients, currents
motions.py     gaits
recordings.py  joint angles over time
runs.py        starts and settings of the model
outcomes.py    how fast a robot swam
telling.py     who hears of a doubt
judging.py     all of these, of a scenario; limit cases in which nothing is judged
"""

from laticauda.scenarios.plausibility.doubts import Doubt as Doubt
from laticauda.scenarios.plausibility.judging import (
    check_described as check_described,
    check_many as check_many,
    check_plausible as check_plausible,
    judge_scenario as judge_scenario,
    limit_case as limit_case,
)
from laticauda.scenarios.plausibility.outcomes import warn_of_speed as warn_of_speed
from laticauda.scenarios.plausibility.telling import (
    telling as telling,
    warn_of_doubt as warn_of_doubt,
)
