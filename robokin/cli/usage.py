"""What is wrong with a command line, in the house's words."""

from __future__ import annotations

from typing import Any

from robokin.errors import did_you_mean


def usage_sentence(error: Any) -> str:
    """A sentence for an error that Typer's parser raises."""
    context = getattr(error, "ctx", None)
    path = context.command_path if context is not None else "robokin COMMAND"
    return f"{_found(error, context)}; `{path} --help` shows the usage"


def _found(error: Any, context: Any) -> str:
    # The parser's own words change between versions, the names of its errors do not.
    kind = type(error).__name__
    message = str(error.format_message()).strip().rstrip(".")
    option = getattr(error, "option_name", None)
    if option is not None and kind == "NoSuchOption":
        parameters = context.command.get_params(context) if context is not None else []
        known = [name for param in parameters for name in param.opts if name.startswith("--")]
        return f"there is no option '{option}'{did_you_mean(option, known)}".rstrip("?")
    if option is not None and kind == "BadOptionUsage":
        if "not take" in message:  # the one error for both mistakes; it knows no command
            return f"{option} has a value, expected {option} alone"
        return f"{option} has nothing after it, expected {option} and a value"
    param = getattr(error, "param", None)
    if param is not None and kind == "MissingParameter":
        return f"{param.metavar or param.name} is missing"
    if "unexpected extra argument" in message:
        extra = message.rpartition("(")[2].removesuffix(")")
        advice = ": a vector with spaces is one argument, in quotes" if extra[:1] in "0123456789.+-[" else ""
        return f"found '{extra}' at the end, expected nothing more{advice}"
    return message[:1].lower() + message[1:]
