"""Degrees of freedom of robots and mechanisms."""
