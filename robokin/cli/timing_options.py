"""The options that say how a path takes its time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from robokin.cli.completion import words
from robokin.cli.option_groups import OptionGroup
from robokin.cli.options import choose, option
from robokin.errors import InputError, shown

if TYPE_CHECKING:
    from robokin.arrays import Array
    from robokin.inverse.rounded_curves import CornerRounding
    from robokin.inverse.time_profiles import MotionLimits
    from robokin.inverse.trajectories import Timing
    from robokin.model import Robot
    from robokin.units import Units

PROFILES = ("cubic", "quintic", "trapezoidal")


ENDLESS = "inf"
"""What is said of a joint that has no limit, or of all of them."""


class TimingOptions(OptionGroup):
    """How long a path takes, and how joints speed up and slow down."""

    duration: Annotated[str | None, option("--duration", "S", "How long it takes, in seconds.")] = None
    max_velocity: Annotated[
        str | None,
        option("--max-velocity", "V", "As short as joints may be fast: one value a second for all, or one for each."),
    ] = None
    max_acceleration: Annotated[
        str | None, option("--max-acceleration", "A", "The same of their acceleration, per second squared.")
    ] = None
    profile: Annotated[
        str | None,
        option("--profile", "NAME", "cubic, quintic or trapezoidal, from point to point.  [default: quintic]",
               words(*PROFILES)),
    ] = None  # fmt: skip
    spline: Annotated[bool, typer.Option("--spline", help="Through the points without a stop, by a cubic spline.")] = (
        False
    )
    blend: Annotated[
        str | None,
        option("--blend", "PART", "Past the points by blends that take this part of a piece, up to 1."),
    ] = None
    blend_radius: Annotated[
        str | None,
        option("--blend-radius", "R", "With --line and --arc: blends that begin at this distance to a point."),
    ] = None
    rate: Annotated[str | None, option("--rate", "HZ", "Rows a second, in place of --steps.")] = None

    def read(self, robot: Robot, units: Units, way: str) -> Timing | None:
        """How the path takes its time, None where nothing is said. Raises InputError."""
        from robokin.inverse.trajectories import Timing, motion_limits

        if not any(value for value in vars(self).values()):
            return None
        named = {"spline": self.spline, "blend": self.blend, "blend-radius": self.blend_radius}
        chosen = [name for name, value in named.items() if value not in (None, False)]
        if len(chosen) > 1:
            raise InputError(f"--{' and --'.join(chosen)} exclude each other, expected one of them")
        passing: Any = chosen[0].removesuffix("-radius") if chosen else "stop"
        if passing != "stop" and self.profile is not None and way == "joint":
            raise InputError(f"--profile is of pieces with a stop at their ends, expected it without --{passing}")
        if passing == "spline" and way != "joint":
            raise InputError(f"--spline is of paths by joints, expected --blend or --blend-radius with --{way}")
        if self.blend_radius is not None and way == "joint":
            raise InputError("--blend-radius is of paths of the tool, expected --line or --arc beside it, or --blend")
        limits = motion_limits(
            robot,
            _joint_values(self.max_velocity, "--max-velocity", robot, units),
            _joint_values(self.max_acceleration, "--max-acceleration", robot, units),
        )
        self._expect_an_end(limits)
        profile: Any = choose(self.profile, PROFILES, "--profile") or "quintic"
        told = {"blend": blend} if (blend := _number(self.blend, "--blend", "a part above 0 and up to 1", 1.0)) else {}
        duration = _number(self.duration, "--duration", "seconds above 0")
        return Timing(limits, profile, duration, passing, rate=_number(self.rate, "--rate", "rows a second"), **told)

    def _expect_an_end(self, limits: MotionLimits) -> None:
        """Raises InputError for limits that limit nothing, where they alone would say how long the path takes."""
        import numpy as np

        given = {"--max-velocity": self.max_velocity, "--max-acceleration": self.max_acceleration}
        told = [name for name, text in given.items() if text is not None]
        if self.duration is None and told and np.isposinf([limits.velocity, limits.acceleration]).all():
            more = " or ".join(["--duration", *(name for name in given if name not in told)])
            raise InputError(
                f"{' and '.join(told)}: found '{ENDLESS}', which limits no joint, expected a value for one or more, or "
                f"{more} beside it"
            )

    def rounding(self, units: Units, way: str) -> CornerRounding | None:
        """How the tool passes by the points between, None where it stops at them. Raises InputError."""
        from robokin.inverse.rounded_curves import CornerRounding

        part = _number(self.blend, "--blend", "a part above 0 and up to 1", 1.0)
        radius = _number(self.blend_radius, "--blend-radius", f"a distance above 0 in {units.length}")
        if way == "joint" or (part is None and radius is None):
            return None
        return CornerRounding(part or 1.0, None if radius is None else radius * units.metres)


def _number(text: str | None, option: str, what: str, most: float = 1e9) -> float | None:
    """A positive number. Raises InputError."""
    from robokin.cli.arguments import split_vector

    if text is None:
        return None
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value <= most or len(split_vector(text)) != 1:
        raise InputError(f"{option}: found '{shown(text)}', expected {what}")
    return value


def _joint_values(text: str | None, option: str, robot: Robot, units: Units) -> Array | None:
    """Positive values (n,) [rad | m] of the joints, of which one may stand for all that turn, or all that slide."""
    import numpy as np

    from robokin.cli.arguments import parse_numbers, split_vector
    from robokin.inverse.trajectories import FASTEST
    from robokin.model.joint_units import joint_factors

    if text is None:
        return None
    turns = [bool(turn) for turn in robot.revolute]
    parts = split_vector(text)
    endless = np.array([part.strip().lower() == ENDLESS for part in parts])
    if endless.all() and len(parts) in (1, robot.n):
        return np.full(robot.n, np.inf)
    if len(parts) == robot.n and endless.any():
        text = ",".join("1" if no else part for no, part in zip(endless.tolist(), parts, strict=True))
    else:
        endless = np.zeros(robot.n, dtype=bool)
    if len(parts) == 1:
        if len({*turns}) > 1:
            raise InputError(f"{option}: found one value for joints that turn and slide, expected {robot.n} values")
        values = np.full(robot.n, parse_numbers(text, option, turns[:1], units, "a value")[0])
    else:
        values = parse_numbers(text, option, turns, units, "a value for each joint")
    if not (values > 0.0).all():
        raise InputError(f"{option}: found '{shown(text)}', expected values above 0")
    limits = values * joint_factors(robot, units)
    if not ((limits >= 1.0 / FASTEST) & (limits <= FASTEST)).all():
        bounds = f"{1.0 / FASTEST:g} to {FASTEST:g} (in rad or m)"
        raise InputError(f"{option}: found '{shown(text)}', expected values from {bounds}")
    return np.asarray(np.where(endless, np.inf, limits))
