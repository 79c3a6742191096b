"""Builds the native kernel with the wheel where there is a C compiler; without one the wheel is the same in Python.

It is one module for all versions of Python from 3.11 on (abi3) and of numpy from 1.26 on: numpy 2's headers make it.
`ROBOKIN_REQUIRE_KERNEL=1` makes a build without it fail. An editable installation gets it beside the sources.
The compiler is `CC`, or the one that made Python; on Windows `CC`, or Visual Studio's.
"""

from __future__ import annotations

import hashlib
import os
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from concurrent.futures import ThreadPoolExecutor
from itertools import repeat
from pathlib import Path, PureWindowsPath
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

WINDOWS = os.name == "nt"

KERNEL = f"robokin/kernel/_native.{'pyd' if WINDOWS else 'abi3.so'}"

# The sources that speak with Python, and those that do not.
MODULE = [
    "module.c",
    "arguments.c",
    "closed_forms.c",
    "curves.c",
    "descents.c",
    "elimination.c",
    "number_text.c",
    "solution_objects.c",
    "swivel_forms.c",
    "told_apart.c",
]
PLAIN = [
    "decimal.c",
    "equations_base.c",
    "lanes_base.c",
    "swivel.c",
]

# What is compiled a second time, for machines that have AVX2; `_base.c` is then for old machines alone.
AVX2 = ["equations_avx2.c", "lanes_avx2.c"]

# Each product and sum is rounded by itself: the same digits with every set of instructions.
# They come after CFLAGS: with -ffast-math sines would be wrong by one, and the process would lose subnormal numbers.
FIRST = [*([] if WINDOWS else ["-fPIC"]), "-fvisibility=hidden"]
LAST = [
    "-O3", "-fno-fast-math", "-fno-unsafe-math-optimizations", "-fno-math-errno", "-fno-trapping-math",
    "-ffp-contract=off",
]  # fmt: skip

# For old machines: compiled in a third of the time, and slower by a fifth to a half.
OLD = ["-O2"]

# The same for Microsoft's compiler.
MICROSOFT_FIRST = ["/nologo", "/MD"]
MICROSOFT_LAST = ["/O2", "/fp:precise", "/std:c11", "/utf-8"]


class KernelHook(BuildHookInterface[Any]):
    """Compiles robokin/kernel/native."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the kernel to a wheel, or put it into the tree for an editable one."""
        root = Path(self.root)
        # It is read when the wheel is packed, after this has returned.
        self.work = tempfile.TemporaryDirectory()
        try:
            kernel = compiled(root / "robokin" / "kernel" / "native", Path(self.work.name))
            if version == "editable":
                # A process may have the old one open: it keeps that.
                fresh = (root / KERNEL).with_suffix(f".{os.getpid()}")
                shutil.copy(kernel, fresh)
                fresh.replace(root / KERNEL)
                self.work.cleanup()
                return
        except (ImportError, OSError, ValueError, subprocess.SubprocessError) as error:
            self.work.cleanup()
            if version == "editable":
                # What an earlier build left stays only where it is that of these sources.
                kept = root / KERNEL
                if kept.is_file() and digest(root / "robokin/kernel/native").encode() not in kept.read_bytes():
                    kept.unlink()
            if os.environ.get("ROBOKIN_REQUIRE_KERNEL") == "1":
                print(getattr(error, "stdout", None) or "", getattr(error, "stderr", None) or "", file=sys.stderr)
                raise
            return
        build_data["force_include"][str(kernel)] = KERNEL
        build_data["pure_python"] = False
        build_data["tag"] = f"cp311-abi3-{self.platform()}"

    def platform(self) -> str:
        """The platform of the wheel's tag: the one that is built for where that is named, as cibuildwheel does."""
        named = os.environ.get("_PYTHON_HOST_PLATFORM")
        if named:
            return named.replace("-", "_").replace(".", "_")
        tag: str = self.build_config.builder.get_best_matching_tag()
        return tag.rpartition("-")[2]


def compiled(sources: Path, work: Path) -> Path:
    """The kernel's file, made of the C sources in a folder; OSError or SubprocessError where that cannot be done."""
    import numpy

    if int(numpy.__version__.partition(".")[0]) < 2:
        raise ValueError("the headers of numpy 1 make a module that numpy 2 refuses")
    if sys.implementation.name != "cpython" or sysconfig.get_config_var("Py_GIL_DISABLED"):
        raise ValueError("not built for Pythons without their lock and for others than CPython")
    includes = [f"-I{sysconfig.get_path('include')}", f"-I{numpy.get_include()}"]
    includes.append(f'-DROBOKIN_SOURCES="{digest(sources)}"')
    compiler, environment = found_compiler()
    build = with_microsoft if is_microsoft(compiler) else with_gnu
    kernel = work / Path(KERNEL).name
    build(compiler, environment, sources, includes, kernel)
    if not kernel.is_file():
        raise OSError("the compiler made nothing")
    return kernel


def digest(sources: Path) -> str:
    """What tells these sources from others."""
    found = hashlib.sha256()
    for path in sorted([*sources.glob("*.c"), *sources.glob("*.h")]):
        found.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return found.hexdigest()[:16]


def with_gnu(
    compiler: list[str], environment: dict[str, str], sources: Path, includes: list[str], kernel: Path
) -> None:
    """Compile as GCC and Clang are told, for this machine or for the one that `CC` or ARCHFLAGS names."""
    flags = [*shlex.split(os.environ.get("ARCHFLAGS", "")), *FIRST, *shlex.split(os.environ.get("CFLAGS", "")), *LAST]
    wanted = {name: includes if name in MODULE else [] for name in [*MODULE, *PLAIN]}
    if "__x86_64__" in run([*compiler, *flags, "-dM", "-E", "-x", "c", os.devnull], environment):
        wanted |= {name: OLD for name in PLAIN if name.endswith("_base.c")}
        wanted |= {"module.c": [*includes, "-DROBOKIN_AVX2"], **{name: ["-mavx2"] for name in AVX2}}
    # The last ones, of vectors, take most of the time; they begin first.
    objects = [str(kernel.with_name(f"{name}.o")) for name in wanted]
    commands = [
        [*compiler, *flags, *more, "-c", str(sources / name), "-o", made]
        for (name, more), made in zip(wanted.items(), objects, strict=True)
    ]
    with ThreadPoolExecutor(os.cpu_count()) as at_once:
        list(at_once.map(run, reversed(commands), repeat(environment)))
    shared = ["-bundle", "-undefined", "dynamic_lookup"] if sys.platform == "darwin" else ["-shared"]
    libraries = [f"-L{Path(sys.base_prefix) / 'libs'}", "-lpython3"] if WINDOWS else ["-lm"]
    run([*compiler, *flags, *shared, *objects, "-o", str(kernel), *libraries], environment)


def with_microsoft(
    compiler: list[str], environment: dict[str, str], sources: Path, includes: list[str], kernel: Path
) -> None:
    """Compile as Microsoft's compiler is told."""
    flags = [*MICROSOFT_FIRST, *os.environ.get("CFLAGS", "").split(), *MICROSOFT_LAST]
    wanted = {name: includes if name in MODULE else [] for name in [*MODULE, *PLAIN]}
    if sysconfig.get_platform() == "win-amd64":
        wanted |= {"module.c": [*includes, "-DROBOKIN_AVX2"], **{name: ["/arch:AVX2"] for name in AVX2}}
    objects = []
    for name, more in wanted.items():
        objects.append(str(kernel.with_name(f"{name}.obj")))
        run([*compiler, *flags, *more, "/c", str(sources / name), f"/Fo{objects[-1]}"], environment)
    # Python's header asks for python3.lib by itself.
    libraries = ["/link", f"/LIBPATH:{Path(sys.base_prefix) / 'libs'}"]
    run([*compiler, *flags, "/LD", *objects, f"/Fe{kernel}", *libraries], environment)


def found_compiler() -> tuple[list[str], dict[str, str]]:
    """The compiler's command, and the environment that it needs. Raises OSError where none is found."""
    environment = dict(os.environ)
    if not WINDOWS:
        return shlex.split(os.environ.get("CC") or sysconfig.get_config_var("CC") or "cc"), environment
    if os.environ.get("CC"):
        return shlex.split(os.environ["CC"], posix=False), environment
    if shutil.which("cl") is None:
        environment |= visual_studio()
    command = shutil.which("cl", path=environment.get("PATH") or environment.get("Path"))
    if command is None:
        raise OSError("there is no compiler")
    return [command], environment


def visual_studio() -> dict[str, str]:
    """The environment of Visual Studio's tools, where they are installed: its own program tells where."""
    where = Path(os.environ.get("PROGRAMFILES(X86)", "")) / "Microsoft Visual Studio" / "Installer" / "vswhere.exe"
    tools = "Microsoft.VisualStudio.Component.VC.Tools.x86.x64"
    asked = ["-latest", "-products", "*", "-requires", tools, "-property", "installationPath"]
    folder = run([str(where), *asked], dict(os.environ)).strip()
    batch = Path(folder) / "VC" / "Auxiliary" / "Build" / "vcvarsall.bat"
    target = {"win-arm64": "arm64", "win32": "x86"}.get(sysconfig.get_platform(), "amd64")
    # cmd has rules of its own for quotes: the line is given as it is.
    said = subprocess.run(
        f'cmd /u /s /c ""{batch}" {target} > nul && set"', check=True, capture_output=True, stdin=subprocess.DEVNULL
    ).stdout.decode("utf-16-le")
    return dict(line.split("=", 1) for line in said.splitlines() if "=" in line[1:])


def is_microsoft(compiler: list[str]) -> bool:
    """Whether a compiler takes the words of Microsoft's."""
    return PureWindowsPath(compiler[0].strip('"')).stem.lower() in ("cl", "clang-cl")


def run(command: list[str], environment: dict[str, str]) -> str:
    """Run a compiler without a word of its own; what it said."""
    done = subprocess.run(
        command, check=True, capture_output=True, text=True, errors="replace", stdin=subprocess.DEVNULL, env=environment
    )
    return done.stdout
