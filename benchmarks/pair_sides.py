"""One side of the pairs: answers, in a process of its own, how long a thing takes it.

`python -m benchmarks.pair_sides SIDE FOLDER` reads a question a line from standard input, and writes a line of JSON for
each: {"seconds": per call or per pose} or {"missing": why}. A peer that aborts ends its own process and no other.
FOLDER holds what is asked about, so that a peer's environment needs no robokin: for each arm an `.npz` with q, T, poses
that are rescued, the joints that are held with their values, and the cells alpha, a, d of its table.
"""

from __future__ import annotations

import ctypes
import importlib
import importlib.metadata
import json
import os
import site
import subprocess
import sys
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

LONG = 0.03
"""Seconds that a measurement takes at least, so that the clock does not matter."""

Way = Callable[[Any], Callable[[], object]]


def taken(action: Callable[[], object]) -> float:
    """The least of some times of an action [s]: of this process, so that what others do meanwhile does not count."""
    action()
    best, spent = np.inf, 0.0
    while spent < LONG:
        start = time.process_time()
        action()
        best = min(best, passed := time.process_time() - start)
        spent += passed
    return float(best)


class Side(ABC):
    """What is measured: WHAT_WAY, of which the way `batch` is one call for all rows, any other a call for each."""

    package = ""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.known: dict[str, Any] = {}

    def version(self) -> str:
        """Which one this is."""
        return importlib.metadata.version(self.package)

    @abstractmethod
    def arm(self, name: str) -> Any:
        """The arm of a name as this side knows it; `rows` are what is asked about."""

    def rows(self, name: str) -> Any:
        return np.load(self.folder / f"{name}.npz")

    def measured(self, what: str, name: str, count: int) -> float:
        """Seconds a call or pose."""
        if name not in self.known:
            self.known[name] = self.arm(name)
        rows = self.rows(name)
        action = getattr(self, what.replace("-", "_"))(self.known[name], rows, count)
        return taken(action) / count


def loop(function: Callable[[Any], object], rows: Any) -> Callable[[], object]:
    """A call for each of some rows."""
    each = [*rows]

    def all_of_them() -> None:
        for row in each:
            function(row)

    return all_of_them


class Robokin(Side):
    package = "robokin"

    def version(self) -> str:
        import robokin

        return f"{robokin.__version__} {robokin.kernel_in_use}"

    def arm(self, name: str) -> Any:
        import robokin

        return robokin.load(name.partition("-q")[0])

    def options(self, rows: Any) -> dict[str, Any]:
        hold = {int(joint): value for joint, value in rows["held"].tolist()}
        return {"hold": hold} if hold else {}

    def fk_one(self, robot: Any, rows: Any, count: int) -> Callable[[], object]:
        from robokin import forward_kinematics

        return loop(lambda q: forward_kinematics(robot, q), rows["q"][:count])

    def fk_batch(self, robot: Any, rows: Any, count: int) -> Callable[[], object]:
        from robokin import forward_kinematics

        q = rows["q"][:count]
        return lambda: forward_kinematics(robot, q)

    def jacobian_one(self, robot: Any, rows: Any, count: int) -> Callable[[], object]:
        from robokin import jacobian

        return loop(lambda q: jacobian(robot, q), rows["q"][:count])

    def jacobian_batch(self, robot: Any, rows: Any, count: int) -> Callable[[], object]:
        from robokin import jacobian

        q = rows["q"][:count]
        return lambda: jacobian(robot, q)

    def ik_one(self, robot: Any, rows: Any, count: int) -> Callable[[], object]:
        from robokin import solve_ik

        options = self.options(rows)
        return loop(lambda T: solve_ik(robot, T, **options), rows["T"][:count])

    def ik_all_objects(self, robot: Any, rows: Any, count: int) -> Callable[[], object]:
        from robokin import solve_ik

        options = self.options(rows)
        return loop(lambda T: [one.q for one in solve_ik(robot, T, **options).solutions], rows["T"][:count])

    def ik_batch(self, robot: Any, rows: Any, count: int) -> Callable[[], object]:
        from robokin import solve_ik

        T, options = rows["T"][:count], self.options(rows)
        return lambda: solve_ik(robot, T, **options)

    def ik_rescued(self, robot: Any, rows: Any, count: int) -> Callable[[], object]:
        from robokin import solve_ik

        return loop(lambda T: solve_ik(robot, T), rows["rescued"][:count])

    def motions_one(self, robot: Any, rows: Any, count: int) -> Callable[[], object]:
        from robokin import solve_ik

        return loop(lambda T: solve_ik(robot, T), rows["T"][:count])

    def motions_all_objects(self, robot: Any, rows: Any, count: int) -> Callable[[], object]:
        from robokin import solve_ik

        return loop(lambda T: [one.q for one in solve_ik(robot, T).solutions], rows["T"][:count])

    def motions_batch(self, robot: Any, rows: Any, count: int) -> Callable[[], object]:
        from robokin import solve_ik

        T = rows["T"][:count]
        return lambda: solve_ik(robot, T)

    def csv_batch(self, robot: Any, rows: Any, count: int) -> Callable[[], object]:
        return lambda: self.command(robot, "csv")

    def npy_batch(self, robot: Any, rows: Any, count: int) -> Callable[[], object]:
        return lambda: self.command(robot, "npy")

    def command(self, robot: Any, ending: str) -> None:
        """`robokin fk` in this process, without its start."""
        import contextlib
        import io

        from robokin.cli import run

        target = self.folder / f"poses-{self.version().split()[-1]}.{ending}"
        target.unlink(missing_ok=True)
        source = str(self.folder / f"rows.{ending}")
        with contextlib.redirect_stderr(io.StringIO()):
            assert run(["fk", robot.id, "-i", source, "-o", str(target), "--cores", "1"]) == 0


class Pinocchio(Side):
    package = "pin"

    def arm(self, name: str) -> Any:
        import pinocchio as pin

        rows = self.rows(name)
        model, parent, before = pin.Model(), 0, np.eye(4)
        for i, (alpha, a, d) in enumerate(zip(rows["alpha"], rows["a"], rows["d"], strict=True)):
            parent = model.addJoint(parent, pin.JointModelRZ(), pin.SE3(before), f"joint{i}")
            c, s = np.cos(alpha), np.sin(alpha)
            before = np.array([[1, 0, 0, a], [0, c, -s, 0], [0, s, c, d], [0, 0, 0, 1.0]])
        return pin, model, model.createData(), pin.SE3(before), parent

    def fk_one(self, arm: Any, rows: Any, count: int) -> Callable[[], object]:
        pin, model, data, _, _ = arm
        return loop(lambda q: pin.forwardKinematics(model, data, q), rows["q"][:count])

    def fk_copy_one(self, arm: Any, rows: Any, count: int) -> Callable[[], object]:
        pin, model, data, tool, last = arm

        def pose(q: Any) -> Any:
            pin.forwardKinematics(model, data, q)
            return (data.oMi[last] * tool).homogeneous

        return loop(pose, rows["q"][:count])

    def jacobian_one(self, arm: Any, rows: Any, count: int) -> Callable[[], object]:
        pin, model, data, _, last = arm
        return loop(lambda q: pin.computeJointJacobian(model, data, q, last), rows["q"][:count])


class Eaik(Side):
    package = "EAIK"

    def arm(self, name: str) -> Any:
        from eaik.IK_DH import DhRobot

        rows = self.rows(name)
        return DhRobot(rows["alpha"], rows["a"], rows["d"])

    def fk_one(self, arm: Any, rows: Any, count: int) -> Callable[[], object]:
        return loop(arm.fwdKin, rows["q"][:count])

    def ik_one(self, arm: Any, rows: Any, count: int) -> Callable[[], object]:
        return loop(arm.IK, rows["T"][:count])

    def ik_batch(self, arm: Any, rows: Any, count: int) -> Callable[[], object]:
        T = rows["T"][:count]
        return lambda: arm.IK_batched(T, 1)


SSIK = {"puma560": "puma560_ik", "ur5e": "ur5e_ik", "crx10ia": "fanuc_crx10ia_ik", "panda": "franka_panda_ik",
        "iiwa14": "iiwa14_ik"}  # fmt: skip
"""The arms that ssik brings."""


class Ssik(Side):
    package = "ssik"

    def arm(self, name: str) -> Any:
        import ssik

        (found,) = [arm for arm in ssik.list_arms() if arm.name == SSIK[name]]
        module = importlib.import_module(found.import_path)
        rows = self.rows(name)
        # Its own model has its own zero: its poses are those of the same joint values there.
        targets = np.array([module.fk(q) for q in rows["q"][:500]])
        return module, targets, lambda: ssik.Manipulator.from_dh(rows["alpha"], rows["a"], rows["d"])

    def ik_one(self, arm: Any, rows: Any, count: int) -> Callable[[], object]:
        module, targets, _ = arm
        # Full turns more or less are the same solution, as they are here.
        return loop(lambda T: module.solve(T, enumerate_windings=False), targets[:count])

    def ik_dh_one(self, arm: Any, rows: Any, count: int) -> Callable[[], object]:
        solver = arm[2]()
        return loop(solver.solve, rows["T"][:count])


class Toolbox(Side):
    package = "roboticstoolbox-python"

    def arm(self, name: str) -> Any:
        import roboticstoolbox as rtb

        rows = self.rows(name)
        links = [rtb.RevoluteDH(alpha=x, a=a, d=d) for x, a, d in zip(rows["alpha"], rows["a"], rows["d"], strict=True)]
        robot = rtb.DHRobot(links)
        return robot, robot.ets()

    def fk_one(self, arm: Any, rows: Any, count: int) -> Callable[[], object]:
        return loop(arm[1].eval, rows["q"][:count])

    def fk_batch(self, arm: Any, rows: Any, count: int) -> Callable[[], object]:
        q = rows["q"][:count]
        return lambda: arm[1].eval(q)

    def jacobian_one(self, arm: Any, rows: Any, count: int) -> Callable[[], object]:
        return loop(arm[1].jacob0, rows["q"][:count])

    def ik_one(self, arm: Any, rows: Any, count: int) -> Callable[[], object]:
        """The C that it writes, compiled, and called from Python as it stands."""
        source = self.folder / "toolbox.c"
        source.write_text(arm[0].analytic_ik().generate("c", "ikine"))
        library = source.with_name(f"toolbox{len(self.known)}{np.random.default_rng().integers(10**9)}.so")
        subprocess.run(["cc", "-O3", "-shared", "-fPIC", str(source), "-o", str(library), "-lm"], check=True)
        solve = ctypes.CDLL(str(library)).ikine
        found, number, near = (ctypes.c_double * 256)(), ctypes.c_int(), ctypes.c_double(1e-9)
        each = [(ctypes.c_double * 16)(*T.ravel().tolist()) for T in rows["T"][:count]]
        return loop(lambda target: solve(target, near, found, ctypes.byref(number)), each)


class Polars(Side):
    package = "polars"

    def arm(self, name: str) -> Any:
        import polars

        polars.thread_pool_size()
        return polars

    def csv_batch(self, polars: Any, rows: Any, count: int) -> Callable[[], object]:
        """Reading as many numbers and writing as many, with no kinematics between."""
        source, target = self.folder / "rows.csv", self.folder / "polars.csv"

        def there_and_back() -> None:
            q = polars.read_csv(source, has_header=False)
            polars.concat([q, q.rename(lambda name: f"x{name}")], how="horizontal").write_csv(target)

        return there_and_back


SIDES = {"native": Robokin, "python": Robokin, "pinocchio": Pinocchio, "eaik": Eaik, "ssik": Ssik,
         "toolbox": Toolbox, "polars": Polars}  # fmt: skip


def answers(side: Side, questions: Iterator[str]) -> Iterator[dict[str, Any]]:
    for question in questions:
        asked = json.loads(question)
        try:
            if asked["what"] == "version":
                yield {"version": side.version()}
            else:
                yield {"seconds": side.measured(asked["what"], asked["arm"], asked["count"])}
        except importlib.metadata.PackageNotFoundError:
            yield {"missing": "not installed"}
        except Exception as error:
            yield {"missing": " ".join(f"{type(error).__name__}: {error}".split())[:90]}


def main() -> None:
    name, folder = sys.argv[1:]
    if name not in ("native", "python") and os.environ.get("PEERS"):
        site.addsitedir(os.environ["PEERS"])  # some stand where a .pth file there says
    # What a peer prints by itself is no answer, be it from Python or from C.
    out, sys.stdout = os.fdopen(os.dup(1), "w"), sys.stderr
    os.dup2(2, 1)
    for answer in answers(SIDES[name](Path(folder)), chain.from_iterable([sys.stdin])):
        print(json.dumps(answer), file=out, flush=True)


if __name__ == "__main__":
    main()
