"""What an installation gets: the locks say it, in step with pyproject.toml, and nothing else decides."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import audit
import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
LOCKS = ("user", "build", "dev", "release", "site", "oldest")


def group(name):
    """The requirements of a dependency group, with those of the groups that it includes."""
    found = []
    for entry in PROJECT["dependency-groups"][name]:
        found += [Requirement(entry)] if isinstance(entry, str) else group(entry["include-group"])
    return found


USER = [Requirement(text) for text in PROJECT["project"]["dependencies"]]
PLOT = [Requirement(text) for text in PROJECT["project"]["optional-dependencies"]["plot"]]
MORE = [
    Requirement(text)
    for name in ("parquet", "pandas", "cluster")
    for text in PROJECT["project"]["optional-dependencies"][name]
]
ASKED = {
    "user": USER,
    "build": group("build"),
    "dev": USER + PLOT + MORE + group("dev"),
    "release": group("release"),
    "site": group("site"),
    "oldest": USER + PLOT + group("test"),
}


def lock(name):
    """What a lock pins: requirements with `==`, each with the hashes of its files."""
    text = (ROOT / ".ci" / "requirements" / f"{name}.txt").read_text().replace("\\\n", " ")
    pinned = []
    for line in text.splitlines():
        if line.strip() and not line.lstrip().startswith("#"):
            requirement, *hashes = re.split(r"\s+--hash=", line.strip())
            pinned.append((Requirement(requirement), hashes))
    return pinned


def versions(name):
    """The versions of each package in a lock (another for another Python)."""
    found = {}
    for requirement, _ in lock(name):
        (specifier,) = requirement.specifier
        found.setdefault(canonicalize_name(requirement.name), set()).add(Version(specifier.version))
    return found


@pytest.mark.parametrize("name", LOCKS)
def test_a_lock_pins_every_package_by_the_hashes_of_its_files_and_names_no_place(name):
    for requirement, hashes in lock(name):
        assert [specifier.operator for specifier in requirement.specifier] == ["=="], requirement
        assert hashes
        assert all(re.fullmatch(r"sha256:[0-9a-f]{64}", part) for part in hashes), requirement
    assert "://" not in (ROOT / ".ci" / "requirements" / f"{name}.txt").read_text()


@pytest.mark.parametrize("name", LOCKS)
def test_a_lock_is_in_step_with_what_is_asked(name):
    found = versions(name)
    for asked in ASKED[name]:
        assert any(asked.specifier.contains(version) for version in found[canonicalize_name(asked.name)]), asked


def test_every_extra_is_described_and_tested():
    text = (ROOT / "docs" / "install.md").read_text()
    for name, wanted in PROJECT["project"]["optional-dependencies"].items():
        assert f".[{name}]" in text, name
        assert {one.name for one in map(Requirement, wanted)} <= {one.name for one in ASKED["dev"]}, name


@pytest.mark.parametrize("name", ["user", "build", "release", "site"])
def test_users_and_releases_get_the_versions_that_developers_test(name):
    tested, found = versions("dev"), versions(name)
    for package in tested.keys() & found.keys():
        assert found[package] <= tested[package], package


def test_the_oldest_versions_are_the_lower_bounds_themselves():
    found = versions("oldest")
    for asked in USER + PLOT:
        (bound,) = asked.specifier
        assert bound.operator == ">="
        assert Version(bound.version) in found[canonicalize_name(asked.name)], asked


def test_a_users_installation_has_no_tools_of_development():
    assert not versions("user").keys() & {
        "pytest",
        "hypothesis",
        "mypy",
        "ruff",
        "matplotlib",
        "hatchling",
        "uv",
        "dask",
    }


def test_the_build_backend_is_the_one_that_was_run():
    required, headers = [Requirement(text) for text in PROJECT["build-system"]["requires"]]
    (bound,) = required.specifier
    assert Version(bound.version) in versions("oldest")[required.name]
    # For the native kernel, which an environment of an older numpy builds without.
    assert headers.name == "numpy"


@pytest.mark.parametrize("arguments", [["--help"], ["fk", "--help"], ["check", "dh", "--help"], ["fk", "puma560"]])
def test_a_start_warns_of_nothing_and_loads_only_what_it_needs(arguments):
    """Whatever the versions are: a library's warning about another would be an error here."""
    environment = {**os.environ, "PYTHONWARNINGS": "error"}
    program = (
        "import sys; from robokin.cli import run; status = run(sys.argv[1:]); "
        "names = {name.partition('.')[0] for name in sys.modules}; "
        "print(sorted(names & {'rich', 'pydantic', 'matplotlib', 'click', 'pygments'}), file=sys.stderr); "
        "sys.exit(status)"
    )
    asked = [*arguments, *(["--q", "home", "--json"] if "puma560" in arguments else [])]
    done = subprocess.run([sys.executable, "-c", program, *asked], env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "[]\n")


def bare(*arguments):
    """A command line by a Python without any package, in the checkout."""
    command = [sys.executable, "-I", "-S", "-c", f"import sys; sys.path.insert(0, {str(ROOT)!r}); "]
    command[-1] += "from robokin.cli import run; sys.exit(run(sys.argv[1:]))"
    return subprocess.run([*command, *arguments], capture_output=True, text=True)


def test_the_first_answer_needs_nothing_installed():
    done = bare("fk", "puma560", "--q", "home")
    assert (done.returncode, done.stderr) == (0, "") and "-149.09" in done.stdout
    assert bare("list").returncode == 0


def test_what_needs_more_says_what_and_how():
    done = bare("ik", "puma560", "--pose", "Trans(300, 400, 500)")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        "robokin: this needs typer, which is not installed; `pip install .` in the checkout installs all it needs\n"
    )


# The audit's words and status, for what pip-audit writes ----------------------------------------------

CLEAN = {"name": "numpy", "version": "2.4.6", "vulns": []}
HOLE = {
    "name": "pyyaml",
    "version": "5.3",
    "vulns": [{"id": "PYSEC-2021-142", "fix_versions": ["5.4"], "aliases": ["CVE-2020-14343"], "description": ""}],
}
SILENT = {"name": "rich", "skip_reason": "Dependency not found on PyPI and could not be audited: rich (15.0.0)"}


def audited(*packages):
    return audit.verdict(json.dumps({"dependencies": packages, "fixes": []}), "")


def test_a_vulnerability_is_a_failure():
    status, text = audited(CLEAN, HOLE, SILENT)
    assert status == 1
    assert "pyyaml 5.3 has PYSEC-2021-142, mended in 5.4" in text


def test_what_the_service_does_not_answer_about_is_said_and_no_failure():
    assert audited(CLEAN, SILENT) == (0, "audit: 1 of 2 packages looked up; the service did not answer about rich")
    assert audited(CLEAN) == (0, "audit: 1 of 1 packages looked up")


def test_a_service_that_is_out_of_reach_is_said_and_no_failure():
    status, text = audit.verdict("", "Traceback …\nConnectionError: no route\n")
    assert status == 0
    assert text == "audit: not done, the service did not answer: ConnectionError: no route"
