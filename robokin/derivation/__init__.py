"""Derivations as a lecture writes them: forward kinematics in symbols, and the steps of closed forms."""
