"""Builds the native kernel with the wheel where there is a C compiler; without one the wheel is the same in Python.

It is one module for all versions of Python from 3.11 on (abi3) and of numpy from 1.26 on: numpy 2's headers make it.
`ROBOKIN_REQUIRE_KERNEL=1` makes a build without it fail. An editable installation gets it beside the sources.
"""

from __future__ import annotations

import os
import platform
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

KERNEL = "robokin/kernel/_native.abi3.so"

# Each product and sum is rounded by itself: the same digits with every set of instructions.
# They come after CFLAGS: with -ffast-math sines would be wrong by one, and the process would lose subnormal numbers.
FIRST = ["-fPIC", "-fvisibility=hidden"]
LAST = [
    "-O3", "-fno-fast-math", "-fno-unsafe-math-optimizations", "-fno-math-errno", "-fno-trapping-math",
    "-ffp-contract=off",
]  # fmt: skip


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
                return
        except (ImportError, OSError, ValueError, subprocess.SubprocessError) as error:
            if os.environ.get("ROBOKIN_REQUIRE_KERNEL") == "1":
                print(getattr(error, "stderr", ""), file=sys.stderr)
                raise
            return
        build_data["force_include"][str(kernel)] = KERNEL
        build_data["pure_python"] = False
        build_data["tag"] = f"cp311-abi3-{self.build_config.builder.get_best_matching_tag().rpartition('-')[2]}"


def compiled(sources: Path, work: Path) -> Path:
    """The kernel's file, made of the C sources in a folder; OSError or SubprocessError where that cannot be done."""
    import numpy

    if int(numpy.__version__.partition(".")[0]) < 2:
        raise ValueError("the headers of numpy 1 make a module that numpy 2 refuses")
    if sys.implementation.name != "cpython" or os.name == "nt" or sysconfig.get_config_var("Py_GIL_DISABLED"):
        raise ValueError("not built for Windows, for Pythons without their lock and for others than CPython")
    compiler = shlex.split(os.environ.get("CC") or sysconfig.get_config_var("CC") or "cc")
    flags = [*FIRST, *shlex.split(os.environ.get("CFLAGS", "")), *LAST]
    includes = [f"-I{sysconfig.get_path('include')}", f"-I{numpy.get_include()}"]
    wanted = {"module.c": includes, "lanes_base.c": []}
    if platform.machine() in ("x86_64", "AMD64"):
        wanted |= {"module.c": [*includes, "-DROBOKIN_AVX2"], "lanes_avx2.c": ["-mavx2"]}
    objects = []
    for name, more in wanted.items():
        objects.append(str(work / f"{name}.o"))
        run([*compiler, *flags, *more, "-c", str(sources / name), "-o", objects[-1]])
    kernel = work / "_native.abi3.so"
    shared = ["-bundle", "-undefined", "dynamic_lookup"] if sys.platform == "darwin" else ["-shared"]
    run([*compiler, *flags, *shared, *objects, "-o", str(kernel), "-lm"])
    if not kernel.is_file():
        raise OSError("the compiler made nothing")
    return kernel


def run(command: list[str]) -> None:
    """Run a compiler without a word of its own."""
    subprocess.run(command, check=True, capture_output=True, text=True, stdin=subprocess.DEVNULL)
