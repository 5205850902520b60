"""What stands where in the arrays of the kernels: state, command, setup, joints, and a sample of the log.

A state is one flat array: the rows below, then qpos, qvel and the links' angles.
"""

from laticauda.actuation.laws import PASSIVE as PASSIVE
from laticauda.actuation.laws import PRESCRIBED as PRESCRIBED
from laticauda.formulas import MOST_NUMBERS

# --- Rows of a state
(
    TIME,
    TIME_REST,
    PHASE,
    AMPLITUDE_NOW,
    AMPLITUDE_RATE,
    FREQUENCY_NOW,
    FREQUENCY_RATE,
    PHASE_SHIFT_NOW,
    PHASE_SHIFT_RATE,
    OFFSET_NOW,
    OFFSET_RATE,
    WORK_ABSOLUTE,
    WORK_NET,
    WORK_POSITIVE,
    WORK_ELECTRICAL,
    PITCH,  # the second wave's PHASE to OFFSET_RATE
) = range(16)
FIN = PITCH + OFFSET_RATE + 1 - PHASE  # those of the third, of a driven fin
SECOND, THIRD, STATE_ROWS = PITCH - PHASE, FIN - PHASE, FIN + OFFSET_RATE + 1 - PHASE

# --- The command and the generator's settings
(
    AMPLITUDE,
    FREQUENCY,
    PHASE_SHIFT,
    OFFSET,
    AHEAD,
    PITCH_COMMAND,
    FIN_COMMAND,
    BANDWIDTH,
    RAMP,
    IS_LED,
    ACTIVE_POWER,  # of the electronics [W]
    N_KNOTS,  # of a recording, which stands behind all rows: time, then angle and rate of every yaw joint; 0: none
    KNOT,  # the last one before now
    JOINT_LAW,  # the numbers of the joint law, if it is one of somebody's own
) = (
    *range(6),
    10,
    *range(15, 22),
)
COMMAND_ROWS = JOINT_LAW + MOST_NUMBERS

# --- Whole numbers that the kernels need
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
    AT_QPOS,
    AT_QVEL,
    AT_QACC,
    AT_XMAT,
    AT_XIPOS,
    AT_SUBTREE_COM,
    AT_CVEL,
    SETUP_SIZE,
) = range(18)

# --- One row of joint parameters: the law, which wave moves it, the gait's envelope, the skin, the motor
(
    LAW,
    WAVE,
    ENVELOPE,  # g, times the share that a prescribed joint does of it; from here on as in `planar.rows`
    STIFFNESS,
    DAMPING,
    PROPORTIONAL_GAIN,
    DERIVATIVE_GAIN,
    SERVO_GAIN,
    STALL_TORQUE,
    NO_LOAD_SPEED,
    FRICTION_TORQUE,
    VISCOUS_FRICTION,
    STALL_POWER,
    JOINT_SIZE,
) = range(14)
YAW_WAVE, PITCH_WAVE, FIN_WAVE, NO_WAVE = range(4)

# --- One sample of the log: the state's rows, then these, then links, then angle, rate, reference, torque of the
# --- body's joints, then the same of the fin's
(COM, COM_RATE, HEADING, HEADING_RATE, ORIENTATION, MEAN_PITCH, SAMPLE_HEADER) = (0, 3, 6, 7, 8, 12, 13)
