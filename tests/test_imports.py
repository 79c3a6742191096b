"""Imports run one way through the house, and each foreign library has one home."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import robokin

PACKAGE = Path(robokin.__file__).parent
ORDER = [
    "errors", "files", "expected", "units", "brief", "spatial", "model", "kinematics", "symbolic", "description",
    "tables", "inverse", "lessons", "workspace", "mobility", "grading", "pictures", "records", "cli", "drawings",
    "symbol_matrices", "documents", "notebook",
]  # fmt: skip
"""Each room imports only rooms before it. description (text to model) also needs the Denavit-Hartenberg
matrices; what calculates must not need description, which `CALCULATING` says."""

CALCULATING = [
    "errors", "expected", "units", "brief", "spatial", "model", "kinematics", "symbolic", "inverse", "lessons",
    "workspace", "mobility", "grading",
]  # fmt: skip
HOMES = {"yaml": "description", "typer": "cli", "rich": "cli/output", "matplotlib": "pictures"}


def modules():
    return sorted(path.relative_to(PACKAGE) for path in PACKAGE.rglob("*.py"))


def imported(path):
    """Dotted names of everything a module imports, also inside functions."""
    for node in ast.walk(ast.parse((PACKAGE / path).read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative imports hide the way"
            yield node.module


def room(dotted):
    parts = dotted.split(".")
    return parts[1] if parts[0] == "robokin" and len(parts) > 1 else None


@pytest.mark.parametrize("path", modules(), ids=str)
def test_imports_run_one_way(path):
    own = path.parts[0].removesuffix(".py")
    if own not in ORDER:
        return  # the package's own __init__ and __main__ stand outside the rooms
    for name in imported(path):
        other = room(name)
        if other is None or other == own:
            continue
        assert ORDER.index(other) < ORDER.index(own), f"{path} imports {name}"
        if own in CALCULATING:
            assert other in CALCULATING, f"{path} calculates and imports {name}"


@pytest.mark.parametrize("path", modules(), ids=str)
def test_each_foreign_library_has_one_home(path):
    for name in imported(path):
        home = HOMES.get(name.split(".")[0])
        assert home is None or path.as_posix().startswith(home), f"{path} imports {name}"


def loaded_by(*arguments):
    """The modules that a command line has imported when it ends."""
    code = (
        "import sys, io\n"
        f"sys.argv = ['robokin', *{list(arguments)!r}]\n"
        "from robokin.cli import run\n"
        "kept, sys.stdout = sys.stdout, io.TextIOWrapper(io.BytesIO())\n"
        "status = run(sys.argv[1:])\n"
        "sys.stdout = kept\n"
        "print(status, *sys.modules)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    status, *names = done.stdout.split()
    assert status == "0", done.stderr
    return set(names)


def test_help_starts_without_the_heavy_libraries():
    assert not {"numpy", "yaml", "rich.console", "pydantic"} & loaded_by("--help")


def test_a_list_of_the_library_reads_no_description_and_needs_no_numbers():
    assert not {"numpy", "yaml", "robokin.description.read"} & loaded_by("list")


def test_a_json_answer_needs_no_table_and_no_validator():
    names = loaded_by("fk", "puma560", "--q", "home", "--json")
    heavy = {"rich.table", "robokin.cli.output.tables", "pydantic", "robokin.description.mechanisms"}
    assert not (heavy | {"robokin.tables.rows"}) & names


def test_a_workspace_in_text_needs_no_matplotlib():
    names = loaded_by("workspace", "puma560", "--samples", "4096")
    assert not [name for name in names if name.startswith("matplotlib")]


def test_importing_the_package_imports_nothing_heavy():
    code = "import sys, robokin; print('numpy' in sys.modules, 'yaml' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]


def test_the_public_names_are_all_there():
    for name in robokin.__all__:
        assert getattr(robokin, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'forward'"):
        robokin.forward  # noqa: B018 - that it raises is the point
