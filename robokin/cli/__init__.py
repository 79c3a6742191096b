"""The command line: one command, one file."""

from robokin.cli.program import main as main
from robokin.cli.program import run as run
