"""What a step leaves behind: the links' unwrapped angles, and one sample of the log."""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false

from typing import no_type_check

import numpy as np

from laticauda.compiling import kernel
from laticauda.mujoco_water.vectors import field
from laticauda.spatial.rows import *


@kernel
@no_type_check
def follow_links(N, order, qpos, links):
    """Angle of every link about the vertical, unwrapped: less than half a turn from what it was."""
    n = N[N_LINKS]
    if N[IS_PLANAR]:
        links[0] = qpos[2]
        for i in range(1, n):
            links[i] = links[i - 1] + qpos[N[N_BASE_QPOS] + i - 1]
        return
    xmat = field(N[DATA], N[AT_XMAT], 9 * N[N_BODIES])
    for i in range(n):
        b = 9 * order[i]
        gap = np.arctan2(xmat[b + 3], xmat[b]) - links[i]
        links[i] += gap - 2.0 * np.pi * np.floor(gap / (2.0 * np.pi) + 0.5)


@kernel
@no_type_check
def write_sample(N, X, J, R, U, mass, order, qpos, qvel, links, sample):
    """One sample of the log.

    `mass` is that of every body, 0 of those that are not the robot's; `order` holds the body of each link.
    """
    n, bodies = N[N_LINKS], N[N_BODIES]
    com, cvel = field(N[DATA], N[AT_SUBTREE_COM], 3 * bodies), field(N[DATA], N[AT_CVEL], 6 * bodies)
    xipos, xmat = field(N[DATA], N[AT_XIPOS], 3 * bodies), field(N[DATA], N[AT_XMAT], 9 * bodies)
    for k in range(STATE_ROWS):
        sample[k] = X[k]
    o, c = STATE_ROWS, 3 * order[0]
    total = 0.0
    for k in range(3):
        sample[o + COM + k] = com[c + k]
        sample[o + COM_RATE + k] = 0.0
    for b in range(1, bodies):
        rx, ry, rz = xipos[3 * b] - com[c], xipos[3 * b + 1] - com[c + 1], xipos[3 * b + 2] - com[c + 2]
        wx, wy, wz = cvel[6 * b], cvel[6 * b + 1], cvel[6 * b + 2]
        sample[o + COM_RATE] += mass[b] * (cvel[6 * b + 3] + wy * rz - wz * ry)
        sample[o + COM_RATE + 1] += mass[b] * (cvel[6 * b + 4] + wz * rx - wx * rz)
        sample[o + COM_RATE + 2] += mass[b] * (cvel[6 * b + 5] + wx * ry - wy * rx)
        total += mass[b]
    for k in range(3):
        sample[o + COM_RATE + k] /= total
    heading, heading_rate, pitch = 0.0, 0.0, 0.0
    at = o + SAMPLE_HEADER
    for i in range(n):
        b = order[i]
        x, y, z = xmat[9 * b], xmat[9 * b + 3], xmat[9 * b + 6]
        wx, wy, wz = cvel[6 * b], cvel[6 * b + 1], cvel[6 * b + 2]
        heading += links[i]
        pitch -= np.arctan2(z, (x * x + y * y) ** 0.5)
        heading_rate += (x * (wz * x - wx * z) - y * (wy * z - wz * y)) / (x * x + y * y)
        sample[at + i] = links[i]
    sample[o + HEADING] = heading / n
    sample[o + HEADING_RATE] = heading_rate / n
    sample[o + MEAN_PITCH] = pitch / n
    if N[IS_PLANAR]:
        sample[o + ORIENTATION], sample[o + ORIENTATION + 3] = np.cos(0.5 * links[0]), np.sin(0.5 * links[0])
        sample[o + ORIENTATION + 1], sample[o + ORIENTATION + 2] = 0.0, 0.0
    else:
        for k in range(4):
            sample[o + ORIENTATION + k] = qpos[3 + k]
    at += n
    for first, count in ((0, n - 1), (n - 1, J.shape[0] - (n - 1))):
        for i in range(count):
            sample[at + i] = qpos[N[N_BASE_QPOS] + first + i]
            sample[at + count + i] = qvel[N[N_BASE_QVEL] + first + i]
            sample[at + 2 * count + i] = R[0, first + i]
            sample[at + 3 * count + i] = U[first + i]
        at += 4 * count
