"""The README's commands run and print what the README shows."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", README, re.MULTILINE | re.DOTALL)


def sessions():
    """Commands with the output that follows them, of all console blocks."""
    for block in blocks("console"):
        command, shown = None, []
        for line in [*block.splitlines(), "$ "]:
            if line.startswith("$ "):
                if command and not command.startswith("make "):
                    yield command, "\n".join(shown).rstrip()
                command, shown = line[2:], []
            else:
                shown.append(line)


def run(command, cwd):
    """What a user sees of a command: both streams, as a shell shows them."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "COLUMNS": "80"}
    done = subprocess.run(
        ["sh", "-c", command], cwd=cwd, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    return done.stdout.rstrip()


NUMBER = re.compile(r"-?\d+\.\d+(?:e[-+]?\d+)?")


def assert_same(printed, shown):
    """The same text, its numbers to 1e-9: the last digit of a sine is the processor's own."""
    assert NUMBER.sub("#", printed) == NUMBER.sub("#", shown)
    numbers = [[float(text) for text in NUMBER.findall(part)] for part in (printed, shown)]
    assert numbers[0] == pytest.approx(numbers[1], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(("command", "shown"), list(sessions()), ids=lambda text: text[:40])
def test_commands_print_what_is_shown(command, shown, tmp_path):
    assert shown, "a command in the README without its output"
    assert_same(run(command, tmp_path), shown)


def test_the_robot_of_the_readme_works(tmp_path):
    (description,) = blocks("yaml")
    assert yaml.safe_load(description)["name"] == "My arm"
    (tmp_path / "arm.yaml").write_text(description)
    for command in re.findall(r"`(robokin [^`]*arm\.yaml[^`]*)`", README):
        done = subprocess.run([sys.executable, "-m", *command.split()], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr


def test_the_python_of_the_readme_prints_what_is_shown(tmp_path):
    (code,) = blocks("python")
    (shown,) = blocks("text")
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.rstrip() == shown.rstrip()


def test_links_lead_somewhere():
    for target in re.findall(r"\]\(([^)#]+)\)", README):
        assert (ROOT / target).exists(), target
