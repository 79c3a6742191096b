"""`robokin serve`: questions on standard input, a line each."""

from __future__ import annotations


def command() -> int:
    """Answer questions on standard input, a line each, until it ends: for programs that ask often.

    A line holds the words of a command line, quoted as in a shell, or a JSON object: the command, the robot, the
    options by their names, and perhaps an id. Each question gets one line, in order: the document that the command
    prints with --json, behind the question's id as input_id. A mistake gets a document with the keys error and
    status, an answer of no its status, 3. Empty lines, and those that begin with #, get no answer.

    Nothing is written to files and no pictures are drawn. The status is 0 when the input ends.

    Examples:
        robokin serve
        sed "s/^/fk puma560 --q /" joints.csv | robokin serve
    """
    import sys

    from robokin.cli.serving import QuestionServer
    from robokin.cli.statuses import say
    from robokin.errors import InputError
    from robokin.files import CLOSED
    from robokin.formats.kept_descriptions import kept_descriptions
    from robokin.tables.sink import Writing, sink

    if sys.stdin is None or 0 in CLOSED:
        raise InputError("standard input is closed, expected questions on it")
    if sys.stdin.isatty():
        say("a question a line, such as fk puma560 --q 0,0,0,0,0,0; Ctrl-D ends")
    with kept_descriptions(), sink(None) as answers:
        lines = sys.stdin.buffer
        CLOSED.add(0)  # no command reads the questions
        Writing.refused = True
        try:
            QuestionServer(lines, answers).run()
        finally:
            CLOSED.discard(0)
            Writing.refused = False
    return 0
