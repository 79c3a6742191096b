"""Imports run one way through the house, and each foreign library has one home."""

from __future__ import annotations

import ast
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

import robokin

PACKAGE = Path(robokin.__file__).parent
ORDER = [
    "errors", "arrays", "expected", "unfinished_work", "files", "json_text", "units", "number_text", "brief",
    "rotation_entries", "spatial", "model", "kernel", "jobs", "assembly", "kinematics", "formats", "tables", "inverse",
    "workspace", "mobility", "derivation", "grading", "pictures", "records", "reports", "quick", "drawings",
    "symbol_matrices", "question_sheets", "documents", "dataframes", "table_view", "notebook", "cli",
]  # fmt: skip
"""Each room imports only rooms before it."""

READING = {"files", "formats", "tables"}
"""What knows paths, streams, YAML keys or rows of files; what calculates imports none of it."""

ANSWERS = ("grading", "answers")
"""The folder that reads what students hand in: a file of a class, a table, the text of an option. Whoever marks is
handed what it has read, or a function that reads it within the answer's budget."""

CALCULATING = [
    "errors", "arrays", "expected", "json_text", "units", "number_text", "brief", "rotation_entries", "spatial",
    "model", "kernel", "jobs", "assembly", "kinematics", "inverse", "workspace", "mobility", "derivation", "grading",
]  # fmt: skip
HOMES = {
    "yaml": "formats", "typer": "cli", "rich": "reports", "matplotlib": "pictures", "PIL": "pictures",
    "pyarrow": "tables", "dask": "jobs", "distributed": "jobs", "pandas": "dataframes",
}  # fmt: skip

ONE_NAME_EACH = {"__init__.py", "__main__.py"}


def modules():
    return sorted(path.relative_to(PACKAGE) for path in PACKAGE.rglob("*.py"))


@cache
def nodes(path):
    """Everything that a module is made of."""
    return [*ast.walk(ast.parse((PACKAGE / path).read_text()))]


def imported(path):
    """Dotted names of everything a module imports, also inside functions."""
    for node in nodes(path):
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
        if own in CALCULATING and path.parts[:2] != ANSWERS:
            assert other not in READING, f"{path} calculates and imports {name}"


def file_imports():
    """Of each module of the package, by its dotted name, those that it imports at any place in it."""
    names = {".".join(["robokin", *path.with_suffix("").parts]).removesuffix(".__init__"): path for path in modules()}
    found = {name: set() for name in names}
    for own, path in names.items():
        for node in nodes(path):
            if isinstance(node, ast.ImportFrom):
                for alias in node.names:
                    whole = f"{node.module}.{alias.name}"
                    found[own].add(whole if whole in names else node.module)
    return {name: {other for other in others if other in names and other != name} for name, others in found.items()}


def test_no_file_imports_one_that_imports_it():
    """Taking away, again and again, every module whose imports are all gone leaves none."""
    left = {name: others for name, others in file_imports().items() if name != "robokin"}
    while True:
        done = {name for name, others in left.items() if not others & left.keys()}
        if not done:
            break
        left = {name: others for name, others in left.items() if name not in done}
    assert not left, sorted(left)


def test_no_two_modules_and_no_two_classes_have_one_name():
    files, classes = {}, {}
    for path in modules():
        if path.name not in ONE_NAME_EACH:
            files.setdefault(path.name, []).append(path)
        for node in nodes(path):
            if isinstance(node, ast.ClassDef):
                classes.setdefault(node.name, []).append(path)
    assert not {name: paths for name, paths in {**files, **classes}.items() if len(paths) > 1}


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
    assert not {"numpy", "yaml", "robokin.formats.read"} & loaded_by("list")


def test_a_json_answer_needs_no_table_and_no_validator():
    names = loaded_by("fk", "puma560", "--q", "home", "--json")
    heavy = {"rich.table", "robokin.reports.page_tables", "pydantic", "robokin.formats.mechanism_fields"}
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


LONGEST_FUNCTION = 60
"""Lines: a screen. The functions of commands are lists of options."""


@pytest.mark.parametrize("path", modules(), ids=str)
def test_a_function_fits_a_screen(path):
    if path.parts[:2] == ("cli", "commands"):
        return
    for node in nodes(path):
        if isinstance(node, ast.FunctionDef):
            assert node.end_lineno - node.lineno < LONGEST_FUNCTION, f"{path}: {node.name}"
