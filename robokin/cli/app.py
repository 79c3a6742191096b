"""The commands by name. A command's module is imported when it is invoked, and no other."""

from __future__ import annotations

import contextlib
import os
import sys
from functools import cache
from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from robokin import __version__
from robokin.cli.statuses import DONE, WRONG_INPUT
from robokin.errors import InputError, shown

COMMANDS = {
    "list": "The library of robots and mechanisms.",
    "new": "A robot of your own: an example, a copy, or a pasted table.",
    "show": "A robot's table, its class, its wrist and its freedoms.",
    "convert": "A robot in another convention or format: YAML, URDF, tables.",
    "validate": "Check descriptions.",
    "schema": "JSON Schemas of descriptions and of each command's documents.",
    "fk": "Forward kinematics: the pose of the end effector.",
    "ik": "Inverse kinematics: all joint values for a pose.",
    "jacobian": "The Jacobian: how freely the tool moves at a configuration.",
    "singular": "Where an arm loses a freedom: shoulder, elbow, wrist.",
    "path": "A path between two configurations, or along a straight line.",
    "plot": "A picture of an arm, a hand or a mechanism, still or turning.",
    "workspace": "What an arm can reach, and how freely the tool can turn.",
    "dof": "Degrees of freedom: Grübler's count and the mobility.",
    "check": "Mark answers: poses, joint values, tables, counts.",
    "frame": "Evaluate a transform expression.",
    "serve": "Answer questions, a line each, for programs that ask often.",
}
"""Every command with its line in the overview; its module is `robokin.cli.commands.<name>_command`."""


class Verbatim:
    """Hands a parameter's text on as it is.

    Every option here is a text, a list of texts or a flag, which the commands read themselves with
    messages of their own. Typer 0.29 would build a pydantic validator for each of them at every start,
    which takes longer than all the rest of `robokin fk`.
    """

    def coerce(self, value: Any, param: Any, ctx: Any) -> Any:
        """The value as the command line gives it; a repeatable option's values as a list."""
        if param.multiple or param.nargs == -1:
            return list(value or ())
        return value


def verbatim(parameters: Any) -> Any:
    """The parameters, their texts handed on as they are (an older Typer does so by itself)."""
    for parameter in parameters:
        if hasattr(parameter, "_runtime_param"):
            parameter._runtime_param = Verbatim()
    return parameters


ALSO = {"--quaternion": "--quat"}
"""Other names of options."""


class TextCommand(TyperCommand):
    """A command whose parameters are texts, and whose help ends with examples."""

    examples: tuple[str, ...] = ()

    def get_params(self, ctx: Any) -> Any:
        """The parameters, help included."""
        return verbatim(super().get_params(ctx))

    def collect_usage_pieces(self, ctx: Any) -> list[str]:
        """What follows the command's name, as it is mostly typed."""
        arguments = [str(param.metavar) for param in self.get_params(ctx) if param.param_type_name == "argument"]
        return [*arguments, "[OPTIONS]"]

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the arguments. Raises InputError for what follows the last, and for an option given two values."""
        from robokin.cli.usage import refuse_second_values, surplus_sentence

        parameters = self.get_params(ctx)
        known = {option for param in parameters for option in param.opts}
        for i, (name, equals, value) in enumerate([argument.partition("=") for argument in args]):
            if ALSO.get(name) in known:
                args[i] = ALSO[name] + equals + value
        if not ctx.resilient_parsing:
            refuse_second_values(parameters, args)
        ctx.allow_extra_args = True
        rest = list(super().parse_args(ctx, args))
        if rest and not ctx.resilient_parsing:
            raise InputError(surplus_sentence(" ".join(rest), ctx.command_path))
        return rest

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """The arguments and the options."""
        arguments, options = [], []
        for param in self.get_params(ctx):
            if param.param_type_name == "argument":
                arguments.append((str(param.metavar), param.help or ""))
            elif (record := param.get_help_record(ctx)) is not None:
                options.append(record)
        for title, rows in (("Arguments", arguments), ("Options", options)):
            if rows:
                with formatter.section(title):
                    formatter.write_dl(rows)

    def format_epilog(self, ctx: Any, formatter: Any) -> None:
        """The examples, a line each."""
        if self.examples:
            with formatter.section("Examples"):
                for example in self.examples:
                    formatter.write(f"{'':{formatter.current_indent}}{example}\n")


class CommandGroup(TyperGroup):
    """The group of commands, each loaded when it is asked for."""

    def get_params(self, ctx: Any) -> Any:
        """The parameters, help included."""
        return verbatim(super().get_params(ctx))

    def list_commands(self, ctx: Any) -> list[str]:
        """The names, in the order of the overview."""
        return list(COMMANDS)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """The command with a name."""
        if cmd_name in COMMANDS:
            module = import_module(f"robokin.cli.commands.{cmd_name}_command")
            # A command that has commands of its own is a group.
            return module.group() if hasattr(module, "group") else build(cmd_name, module.command)
        if ctx.resilient_parsing or cmd_name.startswith("-"):
            return None
        from robokin.cli.usage import command_hint

        raise InputError(f"there is no command '{shown(cmd_name)}'{command_hint(cmd_name, COMMANDS)}")

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """The overview, from `COMMANDS`, so that help imports no command."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@cache
def build(name: str, function: Any) -> Any:
    """A command of its own from a function with Typer's annotations; its docstring is the help."""
    from robokin.cli.option_groups import expanded

    app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
    text, _, examples = str(function.__doc__).partition("Examples:\n")
    app.command(name, cls=TextCommand, help=text.rstrip(), context_settings=CONTEXT)(expanded(function))
    command: Any = typer.main.get_command(app)
    command.examples = tuple(line.strip() for line in examples.splitlines() if line.strip())
    return command


CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 100}

app = typer.Typer(
    name="robokin",
    cls=CommandGroup,
    help="Robot kinematics from a YAML file: robokin COMMAND ROBOT [options].",
    epilog="`robokin COMMAND --help` tells more. ROBOT is a name of `robokin list`, or a path to a description. "
    "Exit status: 0 done, and the answer is yes; 2 the input is wrong; 3 done, and the answer is no; 130 interrupted.",
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings=CONTEXT,
)


def _version(value: bool) -> None:
    if value:
        from robokin import kernel_in_use

        print(f"robokin {__version__} ({kernel_in_use} kernel)")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", "-V", callback=_version, is_eager=True, help="The version, and exit.")
    ] = False,
) -> None:
    """Robot kinematics from a YAML file."""


@cache
def _whole() -> Any:
    """The command of all commands."""
    return typer.main.get_command(app)


def invoke(arguments: list[str]) -> int:
    """Run the command that the arguments name; its status. Raises InputError for a usage that is wrong.

    Typer's own way to run a command is not taken: it ends with status 1 at a closed pipe.
    """
    command: Any = _whole()
    if "_ROBOKIN_COMPLETE" in os.environ:
        command.main(arguments, prog_name="robokin")
    if not arguments:
        with contextlib.redirect_stdout(sys.stderr):
            invoke(["--help"])
        return WRONG_INPUT
    try:
        with command.make_context("robokin", list(arguments)) as context:
            status = command.invoke(context)
    except typer.Exit as end:
        return int(end.exit_code)
    except Exception as error:
        if type(error) is InputError:
            from robokin.cli.usage import by_option

            raise InputError(by_option(str(error), arguments)) from None
        # Typer's errors know what is wrong with the usage; anything else is not for here.
        if not hasattr(error, "format_message"):
            raise
        from robokin.cli.usage import usage_sentence

        raise InputError(usage_sentence(error, arguments)) from None
    return status if isinstance(status, int) else DONE
