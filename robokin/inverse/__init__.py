"""Inverse kinematics: every joint configuration that reaches a pose."""
