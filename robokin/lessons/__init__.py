"""Closed-form inverse kinematics as a lecture writes it down: each step with its formula and its numbers."""
