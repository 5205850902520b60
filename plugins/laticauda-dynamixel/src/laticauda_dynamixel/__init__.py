"""Robots with Dynamixel servos for laticauda."""
