"""Operate the robot, virtual or real: drivers, calibration, the loop, the safety supervisor, estimation, recording."""
