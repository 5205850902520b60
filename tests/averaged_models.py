"""The averaged model of motion that tests steer by: numbers like those of Mamba, of no one gait."""

from laticauda.control import AveragedModel

AVERAGED_MODEL = AveragedModel(
    turn_0=0.02,
    turn_1=0.55,
    bend=1.4,
    bend_lag=0.25,
    speed_0=0.01,
    speed_1=0.08,
    speed_offset=-0.2,
    speed_lag=0.5,
    sway=0.25,
    sway_lag=1.2,
    power_0=1.0,
    power_1=3.0,
    power_exponent=2.3,
    power_offset=9.0,
)
