"""`--cluster`, and folders of parts that are gone on with: options of commands whose work may be long."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Annotated

import typer

from robokin.cli.option_groups import OptionGroup, RowOutputOptions
from robokin.cli.options import option, whole_number
from robokin.errors import InputError

ClusterOption = Annotated[
    str | None,
    option(
        "--cluster",
        "ADDRESS",
        "Work on a Dask cluster: its scheduler's address or file, or local:N for N processes here; the answer is the "
        "same.",
    ),
]

ResumeOption = Annotated[bool, typer.Option("--resume", help="Go on with the parts of a run that was interrupted.")]

PartRowsOption = Annotated[str | None, option("--part-rows", "N", "Rows of a part.  [default: a second of work]")]

SAMPLE_ROWS, POSE_ROWS, SOLUTION_ROWS = 1 << 22, 1 << 20, 1 << 16
"""Rows of a part: about a second of work, of which handing it to a worker is less than a hundredth."""

MOST_ROWS = 1 << 32
"""Rows of a part at most: more are a slip."""


class PartOptions(OptionGroup):
    """Where long work is done, and how it is gone on with."""

    cluster: ClusterOption = None
    resume: ResumeOption = False
    part_rows: PartRowsOption = None

    def is_long(self, output: RowOutputOptions, cores: str | None, input: str | None) -> bool:
        """Whether more than the first core is worth its start, however short the input.

        Raises InputError for options that do not go together.
        """
        if self.cluster is not None and cores is not None:
            raise InputError("--cluster and --cores exclude each other, expected one of them")
        if input is None and (self.cluster is not None or output.folder):
            name = "--cluster" if self.cluster is not None else f"--output {output.file}"
            raise InputError(f"{name}: is for the rows of a file, expected --input FILE with it")
        for name, given in (("--resume", self.resume), ("--part-rows", self.part_rows)):
            if given and not output.folder:
                raise InputError(f"{name}: is about a folder of parts, expected --output FOLDER/ with it")
        return self.cluster is not None or output.folder

    def rows(self, usual: int) -> int:
        """The rows of a part, `usual` ones where nobody says otherwise. Raises InputError."""
        return whole_number(self.part_rows, "--part-rows", 1, MOST_ROWS, grouped=True) or usual


@contextlib.contextmanager
def working_on(address: str | None) -> Iterator[None]:
    """Within, long work is done on a cluster; None for the cores of this machine. Raises InputError, WorkerError."""
    if address is None:
        yield
        return
    from robokin.jobs.cluster import cluster
    from robokin.jobs.ordered_map import WorkerError
    from robokin.unfinished_work import in_order

    with in_order(), contextlib.ExitStack() as held:
        try:
            held.enter_context(cluster(address))
        except (InputError, WorkerError) as error:
            raise type(error)(f"--cluster: {error}") from None
        yield
