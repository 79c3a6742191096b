"""Known vulnerabilities of what the locks install, as pip-audit finds them: status 1 if there are any.

A package that the service does not answer about is named and is no failure: it is then not known whether
it has one. A vulnerability that does not concern the project is left out by `IGNORED`, with the reason.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent

LOCKS = ("user", "build", "dev", "release", "site")

IGNORED: dict[str, str] = {}
"""Identifiers of vulnerabilities that do not concern the project, each with the reason."""


def main() -> int:
    """Audit every lock; the exit status."""
    command = [sys.executable, "-m", "pip_audit", "--disable-pip", "--require-hashes", "--progress-spinner", "off"]
    for lock in LOCKS:
        command += ["--requirement", str(ROOT / ".ci" / "requirements" / f"{lock}.txt")]
    done = subprocess.run([*command, "--format", "json"], capture_output=True, text=True, check=False)
    status, text = verdict(done.stdout, done.stderr)
    print(text)
    return status


def verdict(out: str, err: str) -> tuple[int, str]:
    """The exit status and what to say for what pip-audit wrote."""
    try:
        packages: list[dict[str, Any]] = json.loads(out)["dependencies"]
    except (ValueError, KeyError):
        last = (err.strip().splitlines() or ["it wrote nothing"])[-1]
        return 0, f"audit: not done, the service did not answer: {last}"
    holes = [
        f"audit: {package['name']} {package['version']} has {hole['id']}, mended in "
        f"{', '.join(hole['fix_versions']) or 'no version yet'}"
        for package in packages
        for hole in package.get("vulns", ())
        if hole["id"] not in IGNORED
    ]
    names = {package["name"] for package in packages}
    silent = sorted({package["name"] for package in packages if "skip_reason" in package})
    counts = [f"audit: {len(names) - len(silent)} of {len(names)} packages looked up"]
    if silent:
        some = ", ".join(silent[:3]) + (", …" if len(silent) > 3 else "")
        counts = [f"{counts[0]}; the service did not answer about {some}"]
    return int(bool(holes)), "\n".join(holes + counts)


if __name__ == "__main__":
    sys.exit(main())
