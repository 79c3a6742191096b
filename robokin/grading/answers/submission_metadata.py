"""Whose submission it is, as Gradescope says it.

Source: Gradescope, Autograder specifications, Submission metadata.
"""

from __future__ import annotations

import json

from robokin.errors import InputError
from robokin.files import open_path, read_up_to

LARGEST = 16 << 20


def submitters(path: str) -> list[list[str]]:
    """The names of the users who handed in: numbers and addresses, addresses without their hosts, what they call
    themselves. Raises InputError."""
    with open_path(path, "submission_metadata.json") as stream:
        data = read_up_to(stream, path, LARGEST, "submission_metadata.json")
    try:
        users = [{str(name): str(value) for name, value in user.items()} for user in json.loads(data)["users"]]
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise InputError(f"{path}: found no users, expected Gradescope's submission_metadata.json") from None
    sure = [user[name] for user in users for name in ("sid", "email") if user.get(name)]
    hosts = [user["email"].partition("@")[0] for user in users if user.get("email")]
    return [sure, hosts, [user["name"] for user in users if user.get("name")]]
