"""The commands by name. A command's module is imported when it is invoked, and no other."""

from __future__ import annotations

import sys
from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from robokin import __version__
from robokin.cli import INTERRUPTED
from robokin.errors import InputError, did_you_mean

COMMANDS = {
    "list": "The library of robots and mechanisms.",
    "show": "A robot's table, its class, its wrist and its freedoms.",
    "validate": "Check descriptions.",
    "schema": "The format of descriptions as a JSON Schema.",
    "fk": "Forward kinematics: where is the hand?",
    "frame": "Evaluate a transform expression.",
}
"""Every command with its line in the overview; its module is `robokin.cli.commands.<name>_command`."""


class Commands(TyperGroup):
    """The group of commands, each loaded when it is asked for."""

    def list_commands(self, ctx: Any) -> list[str]:
        """The names, in the order of the overview."""
        return list(COMMANDS)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """The command with a name."""
        if cmd_name in COMMANDS:
            module = import_module(f"robokin.cli.commands.{cmd_name}_command")
            return build(cmd_name, module.command)
        if ctx.resilient_parsing or cmd_name.startswith("-"):
            return None
        hint = did_you_mean(cmd_name, COMMANDS) or f", expected one of {', '.join(COMMANDS)}"
        raise InputError(f"there is no command '{cmd_name}'{hint}")

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """The overview, from `COMMANDS`, so that help imports no command."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


def build(name: str, function: Any) -> Any:
    """A command of its own from a function with Typer's annotations."""
    app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
    app.command(name, help=function.__doc__, context_settings=CONTEXT)(function)
    return typer.main.get_command(app)


CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 100}

app = typer.Typer(
    name="robokin",
    cls=Commands,
    help="Robot kinematics from a YAML file: robokin COMMAND ROBOT [options].",
    epilog="`robokin COMMAND --help` tells more. ROBOT is a name of `robokin list`, or a path to a description.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings=CONTEXT,
)


def _version(value: bool) -> None:
    if value:
        print(f"robokin {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="The version, and exit.")
    ] = False,
) -> None:
    """Robot kinematics from a YAML file."""


def invoke(arguments: list[str]) -> int:
    """Run the command that the arguments name; its status."""
    try:
        status = typer.main.get_command(app).main(arguments, prog_name="robokin", standalone_mode=False)
    except typer.Abort:
        return INTERRUPTED
    except Exception as error:
        # Typer's usage errors know how to show themselves; anything else is not for here.
        if not hasattr(error, "exit_code") or not hasattr(error, "show"):
            raise
        sys.stdout.flush()
        error.show()
        return int(error.exit_code)
    return status if isinstance(status, int) else 0
