"""The README's commands run and print what the README shows."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from documentation import in_a_shell, runs, same, steps

from robokin.formats.first_description import example

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", README, re.MULTILINE | re.DOTALL)


STEPS = [(step.command, step.shown) for step in steps(README) if runs(step.command)]


@pytest.mark.parametrize(("command", "shown"), STEPS, ids=lambda text: text[:40])
def test_commands_print_what_is_shown(command, shown, tmp_path, monkeypatch):
    """In processes of their own, joined by real pipes."""
    assert shown, "a command in the README without its output"
    monkeypatch.chdir(tmp_path)
    printed = in_a_shell(command).decode().rstrip()
    assert same(printed, shown), printed


def test_the_robot_of_the_readme_works(tmp_path):
    (description,) = blocks("yaml")
    assert description == example("arm").text
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
