"""Marking answers: poses, joint values, tables, Jacobians against what is right, within a stated tolerance."""
