"""The reference of the public names, docs/api.md, from their docstrings; `make docs` writes it."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from functools import cached_property
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import robokin

PAGE = Path(__file__).parent.parent / "docs" / "api.md"

GROUPS = {
    "Descriptions": (
        "load", "from_table", "load_tree", "load_mechanism", "load_wheeled", "library_names", "Units",
    ),
    "Models": ("Robot", "Tree", "Mechanism", "WheeledBase", "to_convention"),
    "Kinematics": (
        "forward_kinematics", "tip_poses", "link_frames", "jacobian", "differential_kinematics",
        "singular_configurations", "symbols",
    ),
    "Inverse kinematics and paths": (
        "solve_ik", "swivel_angle", "swivel_solutions", "solve_tips", "interpolate_joints", "follow_line", "trajectory",
    ),
    "Workspace and mobility": ("analyse_workspace", "mobility_of", "manoeuvrability_of"),
    "Marks": (
        "check_pose", "check_configuration", "check_solutions", "check_table", "Tolerance", "default_tolerance",
        "question_sheet", "mark_sheet", "statistics_of",
    ),
    "Poses and rotations": (
        "pose", "pose_parts", "invert_pose", "transform",
        "rotation_from_rpy", "rpy_from_rotation", "rotation_from_euler", "euler_from_rotation",
        "rotation_from_quaternion", "quaternion_from_rotation", "rotation_from_axis_angle", "axis_angle_from_rotation",
        "rotation_from_rotvec", "rotvec_from_rotation",
    ),
    "Pictures": ("draw",),
    "Errors": ("RobokinError", "InputError", "InputTypeError", "DescriptionError"),
    "Documents, data frames and notebooks": ("documents", "dataframes", "notebook"),
}  # fmt: skip
"""Every public name under the heading where it is looked for."""

INSIDE = ("Solution", "Family", "Arc", "TipGroup", "Event")
"""Classes that stand in the results of others, and are read as often as these."""

WIDTH = 110
"""Characters of a call that stands on one line."""

HEAD = """# Public names

Made from the docstrings by `make docs`; to change what stands here, change these. [From Python](python.md) is the way
in, with examples. Lengths are in metres and angles in radians unless it is said otherwise; `(..., n)` is an array of
any leading shape with n numbers in the last place, n being the number of joint variables. An array argument is whatever
numpy makes an array of real numbers of. `robokin.__version__` is the version; `robokin.kernel_in_use` is "native" or
"python" (as the environment variable ROBOKIN_KERNEL asks).
"""


def classes() -> dict[str, str]:
    """The module of each class of the package; no two have one name."""
    package = Path(robokin.__file__).parent
    found = {}
    for path in package.rglob("*.py"):
        module = ".".join(["robokin", *path.relative_to(package).with_suffix("").parts]).removesuffix(".__init__")
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, ast.ClassDef):
                found[node.name] = module
    return found


def functions_of(module: ModuleType) -> dict[str, Any]:
    """The public functions of a public module."""
    named = getattr(module, "__all__", None) or [
        name for name, value in vars(module).items() if getattr(value, "__module__", "") == module.__name__
    ]
    return {name: vars(module)[name] for name in named if inspect.isfunction(vars(module)[name]) and name[0] != "_"}


def members_of(kind: type) -> dict[str, Any]:
    """The public methods of a class, and the functions of its properties, by name."""
    found: dict[str, Any] = {}
    for owner in reversed(kind.__mro__):
        if not owner.__module__.startswith("robokin"):
            continue
        for name, value in vars(owner).items():
            if isinstance(value, property):
                function: Any = value.fget
            elif isinstance(value, cached_property):
                function = value.func
            else:
                function = getattr(value, "__func__", value)
            if inspect.isfunction(function) and not name.startswith("_"):
                found[name] = function
    return found


def public_functions() -> Iterator[tuple[str, Any]]:
    """Everything public that is called or looked up, with its whole name."""
    for name in robokin.__all__:
        value = getattr(robokin, name)
        if inspect.isfunction(value):
            yield name, value
        elif inspect.isclass(value):
            yield from ((f"{name}.{member}", function) for member, function in members_of(value).items())
        elif isinstance(value, ModuleType):
            yield from ((f"{name}.{member}", function) for member, function in functions_of(value).items())


def results() -> list[type]:
    """The classes that public functions return and that are no public names themselves, in the order of these."""
    homes: dict[str, str] = classes()
    found: dict[str, None] = {}
    for _, function in public_functions():
        for word in re.findall(r"\w+", str(inspect.signature(function).return_annotation)):
            if word in homes and word not in robokin.__all__:
                found[word] = None
    return [getattr(import_module(homes[name]), name) for name in dict.fromkeys([*found, *INSIDE])]


def call_of(function: Any, name: str) -> str:
    """How a function is called, on a line, or an argument a line where that is too long."""
    asked = inspect.signature(function)
    parts, starred = [], False
    for one in asked.parameters.values():
        if one.name == "self":
            continue
        if one.kind is one.KEYWORD_ONLY and not starred:
            parts.append("*")
            starred = True
        stars = {one.VAR_POSITIONAL: "*", one.VAR_KEYWORD: "**"}.get(one.kind, "")
        default = "" if one.default is one.empty else f" = {one.default!r}"
        parts.append(f"{stars}{one.name}: {one.annotation}{default}")
    line = f"{name}({', '.join(parts)}) -> {asked.return_annotation}"
    if len(line) <= WIDTH:
        return line
    return "\n".join([f"{name}(", *(f"    {part}," for part in parts), f") -> {asked.return_annotation}"])


def described(value: Any) -> str:
    """A docstring as a part of the page."""
    return inspect.cleandoc(value.__doc__ or "")


def function_section(name: str, function: Any, level: int = 3) -> str:
    """A function with its call and its docstring."""
    return f"{'#' * level} {name}\n\n```python\n{call_of(function, name)}\n```\n\n{described(function)}\n"


def class_section(kind: type) -> str:
    """A class with its fields, its properties and its methods."""
    lines = []
    if is_dataclass(kind):
        lines += [f"- `{part.name}: {part.type}`" for part in fields(kind)]
    for name, function in members_of(kind).items():
        called = call_of(function, name)
        if isinstance(inspect.getattr_static(kind, name), property | cached_property):
            called = f"{name}: {inspect.signature(function).return_annotation}"
        lines.append(f"- `{called}`: " + described(function).replace("\n", "\n  "))
    rest = "\n".join([*lines, ""])
    return (
        f"### {kind.__name__}\n\n{described(kind)}\n\n{rest}"
        if lines
        else f"### {kind.__name__}\n\n{described(kind)}\n"
    )


def section(name: str) -> str:
    """What the page says of a public name."""
    value = getattr(robokin, name)
    if inspect.isclass(value):
        return class_section(value)
    if isinstance(value, ModuleType):
        own = [function_section(f"{name}.{member}", one, 4) for member, one in functions_of(value).items()]
        return "\n".join([f"### {name}\n\n{described(value)}\n", *own])
    return function_section(name, value)


def page() -> str:
    """The whole reference."""
    parts = [HEAD]
    for title, names in GROUPS.items():
        parts += [f"## {title}\n", *map(section, names)]
    parts += ["## Results\n\nWhat these functions return.\n", *map(class_section, results())]
    return "\n".join(parts)
