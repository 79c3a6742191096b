"""A base on wheels. Metres and radians throughout."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from robokin.brief import Described
from robokin.errors import Note, shown
from robokin.expected import expect_kind
from robokin.units import Units


@dataclass(frozen=True)
class Wheel:
    """A wheel of a base, in the base's frame.

    type: `fixed`, `steered`, `castor`, `swedish` or `ball`. x, y [m]: where it touches the ground (a castor: its
    swivel). angle [rad]: the direction in which it rolls, from the x axis, at a steered wheel that of its zero; of a
    ball, the direction in which its motor rolls it. radius [m].
    offset [m]: a castor's, from swivel to wheel. roller [rad]: a Swedish wheel's, from the direction in which the wheel
    rolls to the direction in which its rollers let it slip; 90° for an omni wheel, 45° for a mecanum wheel. driven:
    whether a motor turns the wheel; turned: whether a motor steers it.
    """

    name: str
    type: str
    x: float
    y: float
    angle: float = 0.0
    radius: float = 0.0
    offset: float = 0.0
    roller: float = 0.0
    driven: bool = False
    turned: bool = False


@dataclass(frozen=True, eq=False)
class WheeledBase(Described):
    """A rigid base on wheels on a plane; `parallel` says that its steered wheels always point the same way."""

    name: str
    wheels: tuple[Wheel, ...]
    parallel: bool = False
    id: str = ""
    description: str = ""
    source: str = ""
    units: Units = field(default_factory=Units)
    parameters: Mapping[str, float] = field(default_factory=dict)
    expected: Mapping[str, int] = field(default_factory=dict)
    notes: tuple[Note, ...] = ()

    def __post_init__(self) -> None:
        """Make the mappings read-only."""
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))
        object.__setattr__(self, "expected", MappingProxyType(dict(self.expected)))

    @property
    def types(self) -> str:
        """The wheels by type in words, such as `2 fixed, 1 castor`."""
        counts: dict[str, int] = {}
        for wheel in self.wheels:
            counts[wheel.type] = counts.get(wheel.type, 0) + 1
        return ", ".join(f"{count} {kind}" for kind, count in counts.items())

    def __repr__(self) -> str:
        """A line that names the base."""
        return f"<WheeledBase {self.id or self.name!r}: {len(self.wheels)} wheels>"


def expect_wheeled(value: object, argument: str = "base") -> WheeledBase:
    """The value, if it is a wheeled base. Raises InputTypeError that says how to get one."""
    name = f"'{shown(value)}'" if isinstance(value, str) else "name_or_path"
    base: WheeledBase = expect_kind(
        value, WheeledBase, argument, f"a WheeledBase, as robokin.load_wheeled({name}) gives it"
    )
    return base
