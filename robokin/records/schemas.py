"""The JSON Schema of each command's documents, by the command's name."""

from __future__ import annotations

from importlib import import_module

from robokin.errors import InputError, did_you_mean, or_list, shown
from robokin.records.schema_words import Schema

HOMES = {
    "list": "description_schemas.list_",
    "show": "description_schemas.show",
    "convert": "description_schemas.convert",
    "new": "description_schemas.new",
    "validate": "description_schemas.validate",
    "fk": "pose_schemas.fk",
    "ik": "solution_schemas.ik",
    "path": "pose_schemas.path",
    "jacobian": "pose_schemas.jacobian",
    "singular": "pose_schemas.singular",
    "frame": "pose_schemas.frame",
    "workspace": "workspace_schemas.workspace",
    "dof": "freedom_schemas.dof",
    "plot": "solution_schemas.plot",
    "check": "mark_schemas.CHECKS",
    "serve": "serve_schemas.serve",
}
"""Where each schema is made: only the one that is asked for is loaded."""

CHECKS = ("fk", "ik", "dh", "jacobian", "dof", "new", "sheet", "statistics")
"""What stands behind `robokin check`: each has a schema of its own."""


def document_schema(command: str, check: str | None = None) -> Schema:
    """The JSON Schema of the documents that a command writes; `check` says which of the checks.

    Raises InputError for a name that has none.
    """
    if command not in HOMES:
        expected = did_you_mean(command, HOMES) or f", expected one of {', '.join(HOMES)}"
        raise InputError(f"there is no schema of '{shown(command)}'{expected}")
    if (check is not None) != (command == "check"):
        if check is None:
            raise InputError(f"the kind of check is missing, expected {or_list(CHECKS)} after it")
        raise InputError(f"found '{shown(check)}' after {command}, expected nothing: only check has kinds")
    module, name = HOMES[command].split(".")
    made = getattr(import_module(f"robokin.records.{module}"), name)
    if check is None:
        return dict(made())
    if check not in CHECKS:
        hint = did_you_mean(check, CHECKS) or f", expected {or_list(CHECKS)}"
        raise InputError(f"there is no check '{shown(check)}'{hint}")
    return dict(made[check]())
