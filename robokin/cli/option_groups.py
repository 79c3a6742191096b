"""Options that commands share, declared once as groups.

A parameter of a command whose type is a group stands for all options of the group, in their order: `expanded` puts them
into the command's signature, for the parser and the help, and hands the command the group with what was typed.
"""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, get_type_hints

from robokin.cli.options import (
    FORMATS,
    ROW_FORMATS,
    AngleOption,
    ArrayOutputOption,
    ExactOption,
    FormatOption,
    JsonOption,
    LengthOption,
    OutputOption,
    PackageOption,
    RootOption,
    RowFormatOption,
    RowOutputOption,
    SetOption,
    TipOption,
    effective_units,
    output_format,
    package_folders,
    parameter_overrides,
)
from robokin.errors import InputError

if TYPE_CHECKING:
    from robokin.formats.part import Part
    from robokin.formats.plain_robots import PlainRobot
    from robokin.model import Mechanism, Robot, Tree, WheeledBase
    from robokin.units import Units


class OptionGroup:
    """Options with what was typed for each; a subclass declares them with their defaults."""

    def __init__(self, **typed: Any) -> None:
        self.__dict__.update(typed)


class OutputOptions(OptionGroup):
    """Where the answer goes, and in which format."""

    file: OutputOption = None
    format: FormatOption = None
    json: JsonOption = False

    arrays = rows = False
    """Whether the answer can be an array, and whether it can be a table of rows."""

    @property
    def chosen(self) -> str | None:
        """The format that --format and --json ask for; None when neither does. Raises InputError."""
        return output_format(self.format, self.json, ROW_FORMATS if self.rows else FORMATS)

    @property
    def kind(self) -> str:
        """The format: that of the output's ending, else the chosen one, else a table. Raises InputError."""
        from robokin.tables.sink import format_of

        return format_of(self.file, self.chosen, arrays=self.arrays, rows=self.rows)


class ArrayOutputOptions(OutputOptions):
    """Where an answer goes that can be an array."""

    file: ArrayOutputOption = None

    arrays = True


class RowOutputOptions(ArrayOutputOptions):
    """Where an answer goes that can be an array, or a table of rows for programs that calculate with columns."""

    file: RowOutputOption = None
    format: RowFormatOption = None

    rows = True

    @property
    def kind(self) -> str:
        """The format, Parquet for a folder of parts. Raises InputError, also for bytes that would go to a terminal."""
        if self.folder:
            if self.chosen not in (None, "parquet"):
                said = f"--output {self.file} and --format {self.chosen} say different things"
                raise InputError(f"{said}, expected one of them: parts are Parquet files")
            kind = "parquet"
        else:
            kind = super().kind
        if kind in ROW_FORMATS and kind not in FORMATS:
            from robokin.tables.arrow_library import pyarrow

            pyarrow()  # where it is missing that is said before any work is done
            if self.file is None and sys.stdout is not None and sys.stdout.isatty():
                raise InputError(f"--format {kind}: standard output is a terminal, expected --output FILE or a pipe")
        return kind

    @property
    def folder(self) -> bool:
        """Whether the answer goes to a folder of parts."""
        from robokin.tables.sink import is_folder

        return is_folder(self.file)


class UnitOptions(OptionGroup):
    """The units of what goes in and out."""

    angle: AngleOption = None
    length: LengthOption = None

    def over(self, own: Units) -> Units:
        """Units, with those that were asked for in their place. Raises InputError."""
        return effective_units(own, self.length, self.angle)


class DescriptionOptions(UnitOptions):
    """How a description is read, and the units of what goes in and out."""

    set_: SetOption = None
    tip: TipOption = None
    root: RootOption = None
    exact: ExactOption = False
    package: PackageOption = None

    def words(self, name: str) -> str:
        """The robot with its options as a command line has them, for a shell."""
        import shlex

        words = [name]
        for option, value in vars(self).items():
            if option in ("angle", "length") or not value:
                continue
            flag = "--" + option.strip("_")
            words += (
                [flag]
                if value is True
                else [w for v in ([value] if isinstance(value, str) else value) for w in (flag, v)]
            )
        return shlex.join(words)

    def part(self) -> Part:
        """Which part of a description is meant. Raises InputError."""
        from robokin.formats.part import Part

        return Part(self.tip, self.root, self.exact, package_folders(self.package))

    def entry(self, name: str, mode: int | None = None) -> Robot | Mechanism | WheeledBase:
        """What a name or a path describes, of a tree a chain. Raises InputError.

        `mode` is the way to put a mechanism together.
        """
        from robokin.cli.arguments import load_entry

        return load_entry(name, parameter_overrides(self.set_), mode, self.part())

    def anything(self, name: str, mode: int | None = None) -> Robot | Mechanism | WheeledBase | Tree:
        """The same, or where several tips are meant the tree. Raises InputError."""
        from robokin.cli.arguments import load_noted

        return load_noted(name, parameter_overrides(self.set_), mode, self.part())

    def describes_tree(self, name: str) -> bool:
        """Whether a name or a path describes links and branches, even where these have one tip. Raises InputError."""
        from robokin.formats.library import described_whole
        from robokin.model import Tree

        return isinstance(described_whole(name, parameter_overrides(self.set_), None, self.part()), Tree)

    def robot(self, name: str) -> tuple[Robot, Units]:
        """The robot that a name or a path describes, and the units to use. Raises InputError, also for no robot."""
        from robokin.cli.arguments import load_robot

        robot = load_robot(name, parameter_overrides(self.set_), self.part())
        return robot, self.over(robot.units)

    def plain(self, name: str, robot: Robot) -> PlainRobot | None:
        """The robot as plain numbers, which are kept of the library's own; None where there are none."""
        from robokin.formats.plain_robots import library_robot, plain_robot

        own = not (self.set_ or self.tip or self.root or self.exact or self.package)
        return (library_robot(name) if own else None) or plain_robot(robot)

    def robot_or_tree(self, name: str) -> tuple[Robot | Tree, Units]:
        """The same, or where several tips are meant the tree. Raises InputError."""
        from robokin.cli.arguments import load_jointed

        found = load_jointed(name, parameter_overrides(self.set_), self.part())
        return found, self.over(found.units)

    def tree(self, name: str) -> tuple[Tree, Units]:
        """What a name or a path describes as a tree, whatever its tips, and the units to use. Raises InputError."""
        from robokin.cli.arguments import load_tree_of
        from robokin.formats.part import Part

        part = Part(exact=self.exact, packages=package_folders(self.package), whole=True)
        tree = load_tree_of(name, parameter_overrides(self.set_), part)
        return tree, self.over(tree.units)

    def moving_robot(self, name: str) -> tuple[Robot, Units]:
        """The same of a robot that has joints. Raises InputError."""
        robot, units = self.robot(name)
        if not robot.n:
            raise InputError(f"{robot.name} has no joints, expected a robot that can move")
        return robot, units


def expanded(function: Callable[..., int]) -> Callable[..., int]:
    """A command with the options of its groups in place of the groups."""
    hints = get_type_hints(function, include_extras=True)
    groups: dict[str, tuple[type[OptionGroup], list[str]]] = {}
    parameters: list[inspect.Parameter] = []
    for name, parameter in inspect.signature(function).parameters.items():
        options, group = {name: hints[name]}, hints[name]
        if isinstance(group, type) and issubclass(group, OptionGroup):
            options = get_type_hints(group, include_extras=True)
            groups[name] = group, [*options]
        parameters += [
            parameter.replace(
                name=option,
                kind=inspect.Parameter.KEYWORD_ONLY,
                annotation=hint,
                default=getattr(group, option) if name in groups else parameter.default,
            )
            for option, hint in options.items()
        ]
    if not groups:
        return function

    def command(**typed: Any) -> int:
        for name, (group, options) in groups.items():
            typed[name] = group(**{option: typed.pop(option) for option in options})
        return function(**typed)

    command.__doc__ = function.__doc__
    command.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    return command
