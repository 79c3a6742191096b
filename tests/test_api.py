"""The public names: each has a docstring with shapes, units, errors and source, and the reference shows it."""

from __future__ import annotations

import inspect
import re

import api_reference
import pytest
from api_reference import GROUPS, PAGE, public_functions

import robokin

FUNCTIONS = dict(public_functions())

SHAPE = r"\((?:\.\.\.|[nmk]|\d)(?:,(?: (?:[nmk]|\d)(?: \+ 1)?)?)*\)"
"""The shape of an array, such as (..., n), (m, 4, 4), (n,)."""

UNIT = r"\[(?:m|rad|°|1)(?:, (?:m|rad)| \| (?:m|rad))*\]"

NO_UNIT = {"R", "quaternion", "axis", "values"}
"""Arrays of numbers without a dimension: rotations and directions, and a matrix that is only shown."""

FORMULAS = {
    "forward_kinematics", "link_frames", "jacobian", "differential_kinematics", "solve_ik", "interpolate_joints",
    "mobility_of", "manoeuvrability_of", "rotation_from_rpy", "rpy_from_rotation", "rotation_from_euler",
    "euler_from_rotation", "rotation_from_quaternion", "quaternion_from_rotation", "rotation_from_axis_angle",
    "axis_angle_from_rotation", "rotation_from_rotvec", "rotvec_from_rotation",
}  # fmt: skip
"""What computes by a formula of the field's books, which are named."""


def arrays(function):
    """The names of the array arguments."""
    return [name for name, one in inspect.signature(function).parameters.items() if "ArrayLike" in str(one.annotation)]


def test_every_public_name_has_a_docstring():
    assert [name for name in robokin.__all__[1:] if not getattr(robokin, name).__doc__] == []
    assert [name for name, function in FUNCTIONS.items() if not function.__doc__] == []


@pytest.mark.parametrize("name", [name for name, function in FUNCTIONS.items() if arrays(function)])
def test_an_array_that_goes_in_is_said_with_its_shape_and_its_unit(name):
    text = " ".join(FUNCTIONS[name].__doc__.split())
    for argument in arrays(FUNCTIONS[name]):
        said = re.search(rf"\b{argument}(?:, \w+)*`?:? (?:\w+ ){{0,3}}{SHAPE}", text)
        assert said, f"{argument}: no shape, such as `{argument}: (..., n)`"
        assert argument in NO_UNIT or re.search(UNIT, text[said.end() :]), f"{argument}: no unit, such as [rad | m]"


RETURNING = [name for name, one in FUNCTIONS.items() if re.search(r"Array|Flags", str(one.__annotations__["return"]))]


@pytest.mark.parametrize("name", RETURNING)
def test_an_array_that_comes_out_is_said_with_its_shape(name):
    text = FUNCTIONS[name].__doc__
    assert len(re.findall(SHAPE, text)) > len(arrays(FUNCTIONS[name])), "the shape of what comes out"


def asks(function):
    """Whether a function is given what can be wrong: anything but a plain number."""
    given = [one for one in inspect.signature(function).parameters.values() if one.name != "self"]
    return any(one.annotation != "float" for one in given)


SHOWS_ANYTHING = {"notebook.html_of"}


@pytest.mark.parametrize("name", [name for name, one in FUNCTIONS.items() if asks(one) and name not in SHOWS_ANYTHING])
def test_what_can_go_wrong_is_said(name):
    said = re.findall(r"\bRaises\s+(?:Input|InputType|Expression|Description)Error\b", FUNCTIONS[name].__doc__)
    assert said, "no `Raises …Error` in the docstring"


@pytest.mark.parametrize("name", sorted(FORMULAS))
def test_a_formula_has_its_source(name):
    said = re.findall(r"\bSource\b[^.]*?: .*?(?:19|20)\d\d", " ".join(FUNCTIONS[name].__doc__.split()))
    assert said, "no `Source: author, title, year` in the docstring"


def test_what_is_said_to_be_raised_is_an_error_of_the_package():
    for name, function in FUNCTIONS.items():
        for error in re.findall(r"\b(\w+Error)\b", function.__doc__):
            assert hasattr(robokin.errors, error), name


# The page -----------------------------------------------------------------------------------------------------


def test_every_public_name_stands_under_one_heading():
    names = [name for group in GROUPS.values() for name in group]
    assert sorted(names) == sorted(set(robokin.__all__) - {"__version__", "kernel_in_use"})


def test_the_reference_is_what_the_docstrings_say():
    assert PAGE.read_text() == api_reference.page(), "stale; `make docs` writes it anew"


def test_a_long_call_has_an_argument_a_line():
    lines = api_reference.call_of(robokin.solve_ik, "solve_ik").splitlines()
    assert lines[0] == "solve_ik("
    assert lines[-1] == ") -> Result | BatchResult"
    assert "    task: Task = 'pose'," in lines
    assert api_reference.call_of(robokin.Robot.within_limits, "within_limits") == (
        "within_limits(q: ArrayLike) -> Flags"
    )
