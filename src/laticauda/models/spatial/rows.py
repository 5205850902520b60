"""Layout of the kernels' arrays: state, command, setup, joints, and a sample of the log.

A state is one flat array: the rows below, then qpos, qvel, the link angles and, in a scene, the
contact forces on every link.
"""

from laticauda.motion.gaits import WaveState
from laticauda.motion.joints import JOINT, PASSIVE as PASSIVE, PRESCRIBED as PRESCRIBED
from laticauda.values import MOST_NUMBERS
from laticauda.water.mujoco import AT

# --- Rows of a state
TIME, TIME_REST, PHASE = range(
    3
)  # wave of the yaw joints, with the other fields of gaits.reference.WaveState
PHASE_SHIFT_NOW, OFFSET_NOW = PHASE + 5, PHASE + 7
WORK_ABSOLUTE = PHASE + len(WaveState._fields)  # followed by the net, positive and electrical work
PITCH = WORK_ABSOLUTE + 4  # wave of the pitch joints
FIN = PITCH + len(WaveState._fields)  # wave of a driven fin
SECOND, THIRD, STATE_ROWS = PITCH - PHASE, FIN - PHASE, FIN + len(WaveState._fields)

# --- The command and the generator's settings
(
    AMPLITUDE,  # of the yaw joints, the first field of gaits.reference.WaveTarget
    AHEAD,  # its last field
    PITCH_COMMAND,
    FIN_COMMAND,
    BANDWIDTH,
    RAMP,
    IS_LED,
    ACTIVE_POWER,  # of the electronics [W]
    N_KNOTS,  # of a recording, which is stored after all rows: time, then angle and rate of every yaw joint; 0: none
    KNOT,  # last knot before the current time
    JOINT_LAW,  # parameters of a user-defined joint law
) = (0, 4, 5, 10, *range(15, 22))
COMMAND_ROWS = JOINT_LAW + MOST_NUMBERS

# --- Integers that the kernels need, after the offsets of MuJoCo's data
(
    MODEL,
    DATA,
    N_QPOS,
    N_QVEL,
    N_BASE_QPOS,  # of the root, before the joints
    N_BASE_QVEL,
    N_LINKS,
    N_BODIES,
    IS_IMPLICIT,  # whether any joint is free
    IS_PLANAR,
    HAS_SCENE,  # contact forces are then part of the state
    N_FIN_BODIES,  # their contacts count toward the tail link
    SETUP_SIZE,
) = range(len(AT), len(AT) + 13)

# --- Start of each robot's part in the arrays of all robots in one scene; a last row holds the ends
(
    FIRST_STATE,
    FIRST_GIVEN,
    FIRST_JOINT,
    FIRST_BODY,
    FIRST_COLUMN,
    FIRST_QPOS,
    FIRST_QVEL,
    PLACES,
) = range(8)

# --- One row of joint parameters: the joint's numbers, its law, and the wave that moves it
ENVELOPE, STIFFNESS, DAMPING, DRIVE, MOTOR, STALL_POWER, LAW = JOINT
WAVE = LAW + 1
YAW_WAVE, PITCH_WAVE, FIN_WAVE, NO_WAVE = range(4)

# --- One sample of the log: the state's rows, then these, then links, then angle, rate, reference,
# torque of the
# --- body's joints, then the same for the fin's joints and, in a scene, the contact forces on every
# link
(COM, COM_RATE, HEADING, HEADING_RATE, ORIENTATION, MEAN_PITCH, SAMPLE_HEADER) = (
    0,
    3,
    6,
    7,
    8,
    12,
    13,
)
