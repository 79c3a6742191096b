"""How the native kernel is built: from which sources, by which compilers, and what a failure leaves behind."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from robokin.kernel.native_kernel import native

ROOT = Path(__file__).parent.parent.parent
SOURCES = ROOT / "robokin" / "kernel" / "native"


@pytest.fixture(scope="module")
def build():
    """hatch_build.py as a module."""
    spec = importlib.util.spec_from_file_location("hatch_build", ROOT / "hatch_build.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def said(build, monkeypatch):
    """What a compiler is told, which makes what it is told to make."""
    commands = []

    def run(command, environment):
        commands.append(command)
        for i, word in enumerate(command):
            if word == "-o":
                Path(command[i + 1]).write_bytes(b"made")
            elif word.startswith(("/Fo", "/Fe")):
                Path(word[3:]).write_bytes(b"made")
        return "#define __x86_64__ 1\n"

    monkeypatch.setattr(build, "run", run)
    return commands


def hook_in(build, root):
    class Builder:
        @staticmethod
        def get_best_matching_tag():
            return "cp311-cp311-linux_x86_64"

    class Configuration:
        builder = Builder

    return build.KernelHook(str(root), {}, Configuration, None, str(root), "wheel")


@pytest.mark.skipif(native is None, reason="no native kernel in use")
def test_the_kernel_is_that_of_the_sources(build):
    assert native.sources == build.digest(SOURCES), "the native kernel is of other sources: install the project again"


def test_a_digest_knows_every_source(build, tmp_path):
    (tmp_path / "a.c").write_bytes(b"1")
    found = [build.digest(tmp_path)]
    (tmp_path / "b.h").write_bytes(b"")
    found.append(build.digest(tmp_path))
    (tmp_path / "a.c").write_bytes(b"2")
    found.append(build.digest(tmp_path))
    assert len({*found}) == 3


def test_every_source_is_compiled(build, said, tmp_path):
    build.compiled(SOURCES, tmp_path)
    compiled = {Path(word).name for command in said for word in command if word.endswith(".c")}
    assert compiled == {path.name for path in SOURCES.glob("*.c")}


def test_flags_of_the_environment_stand_before_those_that_the_digits_need(build, said, tmp_path, monkeypatch):
    monkeypatch.setenv("CFLAGS", "-ffast-math -DMINE")
    monkeypatch.setenv("ARCHFLAGS", "-arch x86_64")
    build.compiled(SOURCES, tmp_path)
    for command in said:
        assert command.index("-ffast-math") < command.index("-fno-fast-math")
        assert command.index("-arch") < command.index("-DMINE")


def test_a_machine_without_avx2_is_not_told_of_it(build, said, tmp_path, monkeypatch):
    told = build.run
    monkeypatch.setattr(build, "run", lambda *asked: told(*asked) and "#define __aarch64__ 1\n")
    build.compiled(SOURCES, tmp_path)
    assert not any(word.endswith(("-mavx2", "_avx2.c", "_AVX2")) for command in said for word in command)


def test_instructions_of_old_machines_are_compiled_sparingly(build, said, tmp_path, monkeypatch):
    told = build.run
    for machine, base in (("__x86_64__", "-O2"), ("__aarch64__", "-O3")):
        said.clear()
        monkeypatch.setattr(build, "run", lambda *asked, machine=machine: told(*asked) and f"#define {machine} 1\n")
        build.compiled(SOURCES, tmp_path)
        levels = {
            Path(w).name: [*filter(lambda word: word.startswith("-O"), c)][-1]
            for c in said
            for w in c
            if w.endswith(".c")
        }
        assert {levels.pop("lanes_base.c"), levels.pop("equations_base.c")} == {base}
        assert {*levels.values()} == {"-O3"}


def test_microsofts_compiler_is_told_in_its_words(build, said, tmp_path, monkeypatch):
    monkeypatch.setattr(build, "found_compiler", lambda: ([r"C:\VC\cl.exe"], {}))
    monkeypatch.setattr(build.sysconfig, "get_platform", lambda: "win-amd64")
    build.compiled(SOURCES, tmp_path)
    assert {command[0] for command in said} == {r"C:\VC\cl.exe"}
    assert all({"/fp:precise", "/O2"} <= {*command} for command in said)
    avx2 = [command for command in said if "/arch:AVX2" in command]
    assert ["_avx2.c" in " ".join(command) for command in avx2] == [True, True]
    assert "/LD" in said[-1]
    assert not any(word.startswith("-f") for command in said for word in command)


@pytest.mark.parametrize(
    ("command", "microsoft"), [("cl", True), ("CL.EXE", True), ("clang-cl", True), ("clang", False), ("gcc", False)]
)
def test_who_takes_which_words(build, command, microsoft):
    assert build.is_microsoft([command, "-m64"]) is microsoft


def test_a_failed_editable_build_leaves_no_old_kernel(build, tmp_path, monkeypatch):
    monkeypatch.setenv("CC", str(tmp_path / "none"))
    monkeypatch.delenv("ROBOKIN_REQUIRE_KERNEL", raising=False)
    old = tmp_path / build.KERNEL
    old.parent.mkdir(parents=True)
    old.write_bytes(b"old")
    hook_in(build, tmp_path).initialize("editable", {})
    assert not old.exists()
    hook_in(build, tmp_path).initialize("editable", {})
    old.write_bytes(b"old")
    data = {}
    hook_in(build, tmp_path).initialize("standard", data)
    assert data == {}
    assert old.exists()
    monkeypatch.setenv("ROBOKIN_REQUIRE_KERNEL", "1")
    with pytest.raises((OSError, subprocess.SubprocessError)):
        hook_in(build, tmp_path).initialize("editable", {})
    assert not old.exists()


def test_a_wheels_tag_names_the_platform_that_is_built_for(build, said, tmp_path, monkeypatch):
    monkeypatch.delenv("_PYTHON_HOST_PLATFORM", raising=False)
    data = {"force_include": {}}
    hook = hook_in(build, ROOT)
    hook.initialize("standard", data)
    hook.work.cleanup()
    assert data["tag"] == "cp311-abi3-linux_x86_64"
    assert data["pure_python"] is False
    assert [*data["force_include"].values()] == [build.KERNEL]
    monkeypatch.setenv("_PYTHON_HOST_PLATFORM", "macosx-11.0-arm64")
    assert hook.platform() == "macosx_11_0_arm64"


def test_wheels_are_built_for_the_oldest_python_and_never_without_the_kernel():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    wheels = project["tool"]["cibuildwheel"]
    oldest = project["project"]["requires-python"].removeprefix(">=").replace(".", "")
    assert wheels["build"] == f"cp{oldest}-*"
    for part in (wheels, wheels["macos"]):
        assert part["environment"]["ROBOKIN_REQUIRE_KERNEL"] == "1"
    assert sys.version_info >= (3, 11)
