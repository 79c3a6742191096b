"""Marking answers: poses, joint values, tables, Jacobians against what is right, within a stated tolerance.

`grade_poses`, `grade_configurations`, `grade_jacobians` and `grade_tables` mark the answers of a class.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from robokin.grading.class_marks import grade_configurations as grade_configurations
    from robokin.grading.class_marks import grade_jacobians as grade_jacobians
    from robokin.grading.class_marks import grade_poses as grade_poses
    from robokin.grading.class_marks import grade_tables as grade_tables

__all__ = ["grade_configurations", "grade_jacobians", "grade_poses", "grade_tables"]


def __getattr__(name: str) -> object:
    """Import a public name on first use, so that a module of the room brings no other."""
    if name not in __all__:
        raise AttributeError(f"module 'robokin.grading' has no attribute {name!r}")
    from robokin.grading import class_marks

    return getattr(class_marks, name)
