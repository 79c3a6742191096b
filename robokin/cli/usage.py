"""What is wrong with a command line, in the house's words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from robokin.errors import InputError, did_you_mean, or_list, shown

COMMAND_WORDS = {
    "fk": "forward forward-kinematics fkine direct kinematics",
    "ik": "inverse inverse-kinematics ikine solve solutions",
    "jacobian": "jac jacob velocity velocities manipulability",
    "singular": "singularity singularities",
    "path": "trajectory traj move line interpolate",
    "plot": "draw picture view render visualize visualise",
    "workspace": "reach reachable volume reachability",
    "dof": "mobility freedom freedoms grubler gruebler grübler kutzbach mechanism",
    "check": "grade mark test compare score",
    "frame": "transform transformation rotation rot matrix",
    "list": "ls robots library search find",
    "show": "info describe print table dh cat",
    "convert": "export translate write save urdf latex markdown",
    "new": "create init start template make import",
    "validate": "lint verify valid",
    "schema": "format",
    "serve": "server daemon listen repl stream",
}
"""What else people call a command, by the command."""

OPTION_WORDS = {
    "quaternion quats orientation": ("--quat", "--as"),
    "quat rotation": ("--as", "--rpy"),
    "units unit": ("--length", "--angle"),
    "deg degree degrees rad radian radians": ("--angle",),
    "mm cm metre meter metres meters inch": ("--length",),
    "answers answer file files batch csv": ("--input", "--expect", "--q"),
    "result solution": ("--expect", "--q"),
    "joints joint config configuration angles values theta qs": ("--q", "--from"),
    "position point place translation pos": ("--xyz", "--at", "--point"),
    "target transform goal": ("--pose", "--to", "--xyz", "--ik"),
    "start initial init": ("--from", "--near", "--q"),
    "end finish": ("--to",),
    "guess seed-q q0 closest nearest previous": ("--near",),
    "tolerance tol atol eps": ("--tol", "--tol-position"),
    "param parameter parameters define": ("--set",),
    "out save write": ("--output",),
    "limits ignore-limits nolimits": ("--no-limits",),
    "count number limit top most": ("--max", "--samples", "--steps"),
    "jsonl ndjson table output-format fmt type": ("--format",),
    "image picture png html figure draw": ("--plot", "--output"),
    "points n": ("--samples", "--steps"),
    "random-seed": ("--seed",),
}
"""What else people call an option, and the options that may be meant: those that the command has are offered."""


def command_hint(name: str, known: Iterable[str]) -> str:
    """What to say after a command that does not exist."""
    from robokin.formats.library import library_names

    word = name.casefold().replace("_", "-")
    commands = list(known)
    meant = [command for command in commands if word == command or word in COMMAND_WORDS.get(command, "").split()]
    if meant:
        return f"; did you mean '{meant[0]}'?"
    if word == "help":
        return ", expected `robokin --help` or `robokin COMMAND --help`"
    if word == "version":
        return ", expected `robokin --version`"
    if word in {robot.casefold() for robot in library_names()} or word.endswith((".yaml", ".yml")):
        return f": it is a robot, expected a command before it, such as `robokin show {shown(name)}`"
    return did_you_mean(name, commands) or f", expected one of {', '.join(commands)}"


def refuse_second_values(parameters: Iterable[Any], arguments: list[str]) -> None:
    """Raise InputError where an option that holds one value is given two that differ.

    The parser would keep the last, without a word.
    """
    single = {
        name: param
        for param in parameters
        if param.param_type_name == "option" and not param.multiple and not getattr(param, "is_flag", False)
        for name in param.opts
    }
    repeatable = {
        name for param in parameters if param.param_type_name == "option" and param.multiple for name in param.opts
    }
    given: dict[int, tuple[str, str]] = {}
    rest = iter(arguments)
    for word in rest:
        if word == "--":
            return
        name, equals, value = word.partition("=") if word.startswith("--") else (word[:2], word[2:], word[2:])
        if name in repeatable and not equals:
            next(rest, None)
        if name not in single:
            continue
        if not equals:
            value = next(rest, "")
        before = given.setdefault(id(single[name]), (name, value))
        if before[1] != value:
            raise InputError(
                f"{name} is given twice, with '{shown(before[1])}' and with '{shown(value)}', expected it once"
            )


def usage_sentence(error: Any, arguments: Sequence[str]) -> str:
    """A sentence for an error that Typer's parser raises at a command line.

    Its kind is known by the name of its class and by what was typed: the parser's own words change
    between versions.
    """
    context = getattr(error, "ctx", None)
    path = context.command_path if context is not None else "robokin COMMAND"
    return f"{_found(error, context, arguments)}; `{path} --help` shows the usage"


def _option_hint(option: str, known: list[str]) -> str:
    """The options of the command that may be meant: by another word for them, by their start, by their look."""
    word = option.lstrip("-").casefold()
    meant = [name for words, names in OPTION_WORDS.items() if word in words.split() for name in names if name in known]
    started = [name for name in known if len(word) > 1 and name.startswith(f"--{word}")]
    offered = list(dict.fromkeys([*started, *meant]))[:3]
    if offered:
        return f"; did you mean {or_list(repr(name) for name in offered)}"
    return did_you_mean(option, known).rstrip("?")


def _found(error: Any, context: Any, arguments: Sequence[str]) -> str:
    kind = type(error).__name__
    option = getattr(error, "option_name", None)
    if option is not None and kind == "NoSuchOption":
        parameters = context.command.get_params(context) if context is not None else []
        known = [name for param in parameters for name in param.opts if name.startswith("--")]
        return f"there is no option '{shown(option)}'{_option_hint(option, known)}"
    if option is not None and kind == "BadOptionUsage":  # the one error for both mistakes; it knows no command
        if any(argument.startswith(f"{option}=") for argument in arguments):
            return f"{option} has a value, expected {option} alone"
        return f"{option} has nothing after it, expected {option} and a value"
    param = getattr(error, "param", None)
    if param is not None and kind == "MissingParameter":
        return f"{param.metavar or param.name} is missing"
    if context is not None and hasattr(context.command, "list_commands"):
        return f"a command is missing, expected one of {', '.join(context.command.list_commands(context))}"
    return "these arguments cannot be read"


def surplus_sentence(extra: str, path: str) -> str:
    """A sentence for what follows the last argument that a command takes."""
    advice = ": a vector with spaces is one argument, in quotes" if extra[:1] in "0123456789.+-[" else ""
    return f"found '{shown(extra)}' at the end, expected nothing more{advice}; `{path} --help` shows the usage"


def by_option(sentence: str, arguments: Sequence[str]) -> str:
    """A sentence about an argument of Python, such as `drive: found …`, with the option of that name if it is given."""
    name, colon, rest = sentence.partition(": ")
    option = "--" + name.replace("_", "-")
    given = any(word == option or word.startswith(option + "=") for word in arguments)
    return f"{option}: {rest}" if colon and given else sentence
