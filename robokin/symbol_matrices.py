"""Forward kinematics in symbols for Python: what `robokin fk --symbolic` prints, as texts, LaTeX and source."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from robokin.brief import Answer
from robokin.derivation.symbolic_kinematics import SymbolicKinematics, symbolic_kinematics
from robokin.derivation.symbolic_latex import symbolic_latex
from robokin.expected import expect_flag, expect_kind
from robokin.model import Robot, expect_robot
from robokin.records.symbolic_records import symbolic_record
from robokin.reports.symbolic_pages import symbolic_page
from robokin.units import Units


@dataclass(frozen=True, eq=False, repr=False)
class Symbols(Answer):
    """The matrices of a robot in symbols; lengths and angles in `units`."""

    robot: Robot
    units: Units
    kinematics: SymbolicKinematics

    @property
    def T(self) -> tuple[tuple[str, ...], ...]:  # noqa: N802 - the field's letter
        """The pose of the end effector: (4, 4) expressions."""
        return tuple(map(tuple, self._document()["T"]))

    @property
    def matrices(self) -> dict[str, tuple[tuple[str, ...], ...]]:
        """The matrices that T is the product of, by name: (4, 4) expressions each."""
        return {one["name"]: tuple(map(tuple, one["matrix"])) for one in self._document()["matrices"]}

    @property
    def symbols(self) -> dict[str, float | str]:
        """What each symbol stands for: a number, or an expression in q1, q2, …"""
        return dict(self._document()["symbols"])

    def latex(self) -> str:
        """The matrices as displayed mathematics in LaTeX, for amsmath's bmatrix."""
        return symbolic_latex(self.robot, self.units, self.kinematics)

    def python(self) -> str:
        """The source of a numpy function of the joint values."""
        from robokin.derivation.symbolic_python import python_source

        return python_source(self.robot, self.units, self.kinematics)

    def record(self, units: Units | None = None) -> Any:
        """The document that `robokin fk --symbolic --json` prints; the units are chosen when it is made."""
        if units is not None and units != self.units:
            return symbols(self.robot, units=units, frames=bool(self.kinematics.frames)).record()
        return self._document()

    def _document(self) -> dict[str, Any]:
        return symbolic_record(self.robot, self.units, self.kinematics)

    def __str__(self) -> str:
        """A page of 80 columns."""
        return symbolic_page(self.robot, self.units, self.kinematics)

    def __repr__(self) -> str:
        """A line that names the robot."""
        return f"<symbols of {self.robot.id or self.robot.name}: {' '.join(self.kinematics.matrices)}>"

    def _repr_html_(self) -> str:
        from robokin.reports.html_pages import html_text

        return html_text(str(self))


def symbols(robot: Robot, numbers: bool = False, frames: bool = False, units: Units | None = None) -> Symbols:
    """Forward kinematics in symbols: `symbols(robot).T[0][3]` is a text such as `a1*c1 + a2*c12`.

    `numbers` writes lengths and twists as numbers, `frames` adds the frame after each row of the table. Raises
    InputError where the expressions are too long to be of use.
    """
    robot = expect_robot(robot)
    own = robot.units if units is None else units
    expect_kind(own, Units, "units", "units, such as robokin.Units('mm', 'deg')")
    plain, every = expect_flag(numbers, "numbers"), expect_flag(frames, "frames")
    return Symbols(robot, own, symbolic_kinematics(robot, own, numbers=plain, frames=every))
