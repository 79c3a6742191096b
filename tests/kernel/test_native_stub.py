"""What `_native.pyi` says of the native kernel is what the native kernel has."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from robokin.kernel.native_kernel import native

STUB = Path(__file__).parent.parent.parent / "robokin" / "kernel" / "_native.pyi"
pytestmark = pytest.mark.skipif(native is None, reason="no native kernel in use")


@pytest.fixture(scope="module")
def body():
    return ast.parse(STUB.read_text()).body


@pytest.fixture(scope="module")
def functions(body):
    return [part for part in body if isinstance(part, ast.FunctionDef)]


def test_it_lists_what_the_module_has(body, functions):
    names = [name for name in dir(native) if not name.startswith("_")]
    listed = [part.name for part in functions]
    listed += [part.target.id for part in body if isinstance(part, ast.AnnAssign)]
    assert sorted(listed) == sorted(names)


def test_constants_have_the_types_that_it_says(body):
    for part in body:
        if isinstance(part, ast.AnnAssign):
            assert type(getattr(native, part.target.id)).__name__ == part.annotation.id


def test_each_function_has_the_parameters_of_the_modules_own_words(functions):
    for part in functions:
        said = re.match(r"(\w+)\((.*?)\)", getattr(native, part.name).__doc__)
        named = re.findall(r"\w+", said[2].replace("=None", ""))
        needed = re.findall(r"\w+", re.sub(r"\[.*|\w+=None", "", said[2]))
        assert said[1] == part.name
        assert [one.arg for one in part.args.posonlyargs] == named
        assert len(part.args.defaults) == len(named) - len(needed), part.name
        assert not part.args.args, part.name  # the module takes no names


def test_each_function_has_a_sentence(functions):
    for part in functions:
        said = ast.get_docstring(part)
        assert said is not None, part.name
        assert said.endswith("."), part.name
