"""Words that the sections on steered swimmers have in common: who swam, and how it was computed."""

import math
from collections.abc import Iterator, Mapping, Sequence

from laticauda.gaits import GAIT_WORDS
from laticauda.paper.report.efficiency import JOINTS, water_in_words
from laticauda.paper.swimmers import Swimmer
from laticauda.trial.contents import Setting


def swimmers_in_words(swimmers: Sequence[Swimmer], how: Mapping[str, Setting]) -> Iterator[str]:
    """Model, joints, robots, gaits and waters.

    Args:
        swimmers: Who swam.
        how: How every run was computed.
    """
    ramp = f"the amplitude rises over the first {how['ramp']:g} s" if how["ramp"] else "the gait starts at once"
    yield (
        f"Model: {how['model']}; joints: {how['joints']}. {JOINTS.get(str(how['joints']), '')} Time step "
        f"{how['dt']:g} s; {ramp}; bandwidth of the offset in the reference generator {how['offset_bandwidth']:g} "
        "rad/s."
    )
    gaits = {swimmer.gait: swimmer.water for swimmer in swimmers}
    for gait, water in gaits.items():
        amplitude, frequency, shift = (
            f"{math.degrees(angle):.6g}" for angle in (gait.amplitude, gait.frequency, gait.phase_shift)
        )
        robots = dict.fromkeys(f"{one.robot} ({one.length:g} m)" for one in swimmers if one.gait == gait)
        yield (
            f"{GAIT_WORDS[gait.kind].capitalize()}: amplitude {amplitude} deg, frequency {frequency} deg/s, phase "
            f"shift {shift} deg, as in the paper's path-following trials; robots {' and '.join(robots)}; water "
            f"{water_in_words(water)}."
        )
