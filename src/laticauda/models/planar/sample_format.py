"""What a sample of the log and a state vector hold, and in which order: said here and nowhere else.

A *sample* is the header's state (TIME to WORK_ELECTRICAL), then the first of `LOGGED_OF_JOINT` of all
joints, then the second of all joints, and so on. Joints are counted from the tail: joint j is the one
at the tail end of body j + 1. A *state vector*, which runs hand on and trials store, is the begin of a
sample: `LOGGED_OF_JOINT` begins with `STATE_OF_JOINT`.

`stepping.write_sample` and `stepping.read_sample` compile `column_of_joint`; all other code asks the
functions below. (Shapes are not annotated: tests would wrap the functions of this module to check
them, and Numba cannot compile a wrapper.)
"""

import numpy as np

from laticauda.models.planar import rows
from laticauda.models.planar.rows import LOG_STATE, TIME


def column_of_joint(place: int, joint: int, n_joints: int) -> int:
    """Return the column of a joint's number that stands at this place in `LOGGED_OF_JOINT`."""
    return LOG_STATE + place * n_joints + joint


def column_of(row: int) -> int:
    """Return the column of a state row of the header."""
    return row - TIME


def place_of(row: int) -> int:
    """Return the place of a row of a joint in `LOGGED_OF_JOINT`."""
    return rows.LOGGED_OF_JOINT.index(row)


def columns_of_joints(row: int, n_joints: int) -> slice:
    """Return the columns of a row of all joints, one of `LOGGED_OF_JOINT`."""
    place = place_of(row)
    return slice(column_of_joint(place, 0, n_joints), column_of_joint(place, n_joints, n_joints))


def size_of_state(n_joints: int) -> int:
    """Return the count of the numbers of a state vector."""
    return column_of_joint(len(rows.STATE_OF_JOINT), 0, n_joints)


def size_of_sample(n_joints: int) -> int:
    """Return the count of the numbers of a sample."""
    return column_of_joint(len(rows.LOGGED_OF_JOINT), 0, n_joints)


def rows_of_state(n_joints: int) -> np.ndarray:
    """Return the rows of the kernels' array that make up a state vector, in its order."""
    header = TIME + np.arange(LOG_STATE)
    bodies = rows.HEADER_ROWS + np.arange(1, n_joints + 1) * rows.BODY_ROWS
    return np.concatenate((header, *(bodies + row for row in rows.STATE_OF_JOINT)))


def view_joints(samples: np.ndarray, n_joints: int) -> np.ndarray:
    """Return a view of what samples hold of the joints: by sample, `place_of`, joint, and lane if there are any."""
    n_samples, _, *lanes = samples.shape
    return samples[:, LOG_STATE:].reshape(n_samples, len(rows.LOGGED_OF_JOINT), n_joints, *lanes)
