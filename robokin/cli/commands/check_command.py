"""`robokin check`: the grader's verb, a group of commands by what they mark."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from robokin.cli.app import CONTEXT, CommandGroup, build
from robokin.errors import InputError, did_you_mean, or_list, shown

CHECKS = {
    "fk": "A pose for joint values.",
    "ik": "Joint values for a pose: one answer, or all solutions.",
    "dh": "Tables: is it the same robot, and where does it differ?",
    "jacobian": "A 6×n matrix, entry by entry.",
    "dof": "A count of freedoms, and the true mobility.",
    "new": "A sheet of questions with other numbers for each student, and its key.",
    "sheet": "The answers of a class to such a sheet.",
    "statistics": "Of a class's marks: how hard each question was, which mistakes.",
}
"""What can be checked; each has its module `robokin.cli.commands.check_<name>`."""

SHARED = (
    ("--tol L, --tol-angle A", "How far positions and angles may be off; the output says it."),
    ("-i, --input FILE", "fk, ik: a CSV with many answers, of one student or of a class."),
    ("--budget SECONDS", "Processor time for each answer, after which it is not decided."),
    ("--partial SCORE", "The least score of an answer with a known mistake, such as another unit."),
    ("--feedback LEVEL", "What is told: verdict, part, distance, answer."),
    ("--gradescope FILE", "Also write the results.json that Gradescope reads."),
    ("-o, --output FILE", "Write to a file, by its ending: .csv, .jsonl or .json."),
    ("-f, --format FORMAT", "table, json, jsonl or csv.  [default: table]"),
    ("--json", "Short for -f json."),
    ("-h, --help", "Show this message and exit; after KIND, its own."),
)

EXAMPLES = (
    'robokin check fk puma560 --q home --expect "-149.09, 921.12, 20.32"',
    "robokin check ik planar3r-brac --xy 26.4743,50.8716 --phi 85 --q 30,45,10",
    "robokin check dh arm.yaml --against robots/arm.yaml --json",
    "robokin check dof --links 4 --joints 4R --space planar --expect 1",
    "robokin fk puma560 -i joints.csv -f csv | robokin check fk puma560 -i -",
)


class CheckGroup(CommandGroup):
    """The checks, each loaded when it is asked for."""

    def collect_usage_pieces(self, ctx: Any) -> list[str]:
        """What follows the command's name."""
        return ["KIND", "...", "[OPTIONS]"]

    def list_commands(self, ctx: Any) -> list[str]:
        """The names, in the order of the overview."""
        return list(CHECKS)

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """As a group; without a kind, a sentence that names them."""
        if not args and not ctx.resilient_parsing:
            raise InputError(f"KIND is missing, expected {or_list(CHECKS)}; `robokin check --help` shows the usage")
        return list(super().parse_args(ctx, args))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """The check with a name."""
        if cmd_name in CHECKS:
            module = import_module(f"robokin.cli.commands.check_{cmd_name}_command")
            command = build(cmd_name, module.command)
            if hasattr(module, "arguments"):
                parse = command.parse_args
                command.parse_args = lambda context, words: parse(context, module.arguments(words))
            return command
        if ctx.resilient_parsing or cmd_name.startswith("-"):
            return None
        hint = did_you_mean(cmd_name, CHECKS) or f", expected {or_list(CHECKS)}"
        raise InputError(f"there is no check '{shown(cmd_name)}'{hint}")

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """The checks, and the options that most of them have."""
        with formatter.section("Kinds"):
            formatter.write_dl(list(CHECKS.items()))
        with formatter.section("Options"):
            formatter.write_dl(list(SHARED))

    def format_epilog(self, ctx: Any, formatter: Any) -> None:
        """The examples, a line each."""
        with formatter.section("Examples"):
            for example in EXAMPLES:
                formatter.write(f"{'':{formatter.current_indent}}{example}\n")


def group() -> CheckGroup:
    """The command, which has commands of its own."""
    return CheckGroup(
        name="check",
        help=(
            "Mark answers. The status is 0 when all are right and 3 when one is wrong; partial credit, what was "
            "expected, what was given and the error are in the output. `robokin check KIND --help` tells more."
        ),
        rich_markup_mode=None,
        context_settings=CONTEXT,
    )
