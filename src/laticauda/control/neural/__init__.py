"""Gaits by neurons: oscillators that are coupled along the body, driven from above, and may feel what the body feels.

network.py            what all such controllers share: chain, cuts, feedback, steering from above
phase_oscillators.py  one oscillator per joint with a phase and an amplitude (Ijspeert et al. 2007)
oscillator_motion.py  their motion, compiled (template)
half_centers.py       two neurons per joint that inhibit each other (Matsuoka 1985)
many.py               the networks of many robots, stepped side by side
"""

from laticauda.control.neural.half_centers import HalfCenters as HalfCenters
from laticauda.control.neural.network import Feedback as Feedback, NeuralGait as NeuralGait
from laticauda.control.neural.phase_oscillators import PhaseOscillators as PhaseOscillators
