"""Inverse kinematics: the pressures that bring an actuator's tip to given points."""
