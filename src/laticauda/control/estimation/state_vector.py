"""Estimated vector of the filter: which entry is what.

It begins with the smooth motion (`X` to `SLIP`), goes on with the shares of the body's bending
modes in heading and position (`HEADING_GAIN`, `ACROSS_GAIN`) and the ripple of the gait (from
`RIPPLE` on), and ends with a deviation and its rate for every joint (from `JOINTS` on).
"""

import numpy as np

X = 0
"""Position of the smooth motion along the world x axis [m]."""
Y = 1
"""Position of the smooth motion along the world y axis [m]."""
U = 2
"""Surge: speed through the water along the smooth heading [m/s]."""
S = 3
"""Sway: speed through the water to its left [m/s]."""
VX = 4
"""Velocity of the water along the world x axis [m/s]."""
VY = 5
"""Velocity of the water along the world y axis [m/s]."""
H = 6
"""Smooth heading [rad]."""
R = 7
"""Its rate, as far as bending does not cause it [rad/s]."""
TURN = 8
"""Rate of turning per mean joint angle [1/s]."""
SLIP = 9
"""Sideways speed per mean joint angle [m/s]."""
N_SMOOTH = 10

N_MODES = 4
"""Bending modes of the body whose shares are estimated."""
HEADING_GAIN = slice(N_SMOOTH, N_SMOOTH + N_MODES)
"""Contribution of each bending mode to the heading [-]."""
ACROSS_GAIN = slice(N_SMOOTH + N_MODES, N_SMOOTH + 2 * N_MODES)
"""Contribution of each bending mode to the position across the heading [m]."""

# Motion that repeats with the gait is a rotating phasor (c, s) per harmonic; its contribution to
# the motion is c.
HEADING = 0
"""Kind of a ripple: of the heading [rad]."""
ALONG = 1
"""Kind of a ripple: of the position along the heading [m]."""
ACROSS = 2
"""Kind of a ripple: of the position to its left [m]."""
RIPPLES = ((HEADING, 1), (HEADING, 3), (ALONG, 1), (ALONG, 2), (ACROSS, 1), (ACROSS, 2))
"""Kind and harmonic of every ripple, in the order of their phasors."""
RIPPLE = N_SMOOTH + 2 * N_MODES
"""First entry of the first phasor."""
JOINTS = RIPPLE + 2 * len(RIPPLES)
"""First joint's deviation from its reference [rad]; then its rate [rad/s]; then the next joint."""

RIPPLE_KIND = np.array([kind for kind, _ in RIPPLES])
RIPPLE_HARMONIC = np.array([harmonic for _, harmonic in RIPPLES])
RIPPLE_C = np.arange(RIPPLE, JOINTS, 2)
"""Entries of c of all phasors; those of s come right after each."""
RIPPLE_S = RIPPLE_C + 1
RIPPLE_C_OF_KIND = [RIPPLE_C[kind == RIPPLE_KIND] for kind in (HEADING, ALONG, ACROSS)]
"""Entries of c of the phasors of each kind."""
IS_OF_KIND = np.arange(3)[:, np.newaxis] == RIPPLE_KIND
"""Whether a phasor is of a kind, a row for each kind."""
