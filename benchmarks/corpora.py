"""Descriptions from the wild: how many of a folder's URDF, xacro, MJCF and SDF files are read, and whether they agree.

`python -m benchmarks.corpora [DIR …]` walks the folders, by default the installed packages of the Python that runs it,
and reads each different file once. The poses of every link, body and site at random joint values are compared with
those of Pinocchio and MuJoCo where these can be imported (put their site-packages into PYTHONPATH; `xacro` expands
macros for them), of yourdfpy where neither can, and of a short product of the file's own numbers. `--every` names every
file that is refused.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import re
import sys
import sysconfig
import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

import robokin
from benchmarks import corpus_peers, machine
from robokin.errors import InputError
from robokin.formats.foreign_files import MACROS
from robokin.formats.xacro import read_xacro
from robokin.model import Tree
from robokin.model.graph import Graph, Tip

SEED = 560
AGREED = 1e-9
"""Greatest difference [m, or of an entry of a rotation], relative to a robot of more than a metre."""

TRIES = 3
"""Joint values that each file is compared at."""

FORMATS = {".urdf": "URDF", ".xacro": "xacro", ".xml": "MJCF", ".mjcf": "MJCF", ".sdf": "SDF"}
OUTCOMES = ("agree", "DIFFER", "alone", "refused", "crash")
"""What becomes of a file; alone: it is read and there is no peer that reads it too."""

LARGEST = 1 << 24
"""Bytes of a file that is read: no description is larger."""

BEFORE_THE_ROOT = re.compile(rb"<!--.*?-->|<[?!][^>]*>", re.DOTALL)


@dataclass
class Case:
    """A file: how it was read and with whom it agrees; differences: the greatest by the name of each peer."""

    path: Path
    kind: str
    refusal: str = ""
    crash: str = ""
    differences: dict[str, float] = field(default_factory=dict)
    peers_say: dict[str, str] = field(default_factory=dict)
    joints: int = 0
    seconds: float = 0.0

    @property
    def outcome(self) -> str:
        """What became of the file, in a word."""
        if self.crash or self.refusal:
            return "crash" if self.crash else "refused"
        if not self.differences:
            return "alone"
        return "agree" if max(self.differences.values()) < AGREED else "DIFFER"


def descriptions(folders: Sequence[Path]) -> Iterator[tuple[Path, str, bytes]]:
    """The different description files in folders, their formats and contents, in the order of their paths."""
    seen: set[bytes] = set()
    for folder in folders:
        for place, inner, names in os.walk(folder):
            inner.sort()
            for name in sorted(names):
                path = Path(place, name)
                kind = FORMATS.get(path.suffix.lower())
                try:
                    if kind is None or path.stat().st_size > LARGEST or not path.is_file():
                        continue
                    data = path.read_bytes()
                except OSError:
                    continue
                if path.suffix.lower() == ".xml" and not is_mjcf(data):
                    continue
                if kind == "URDF" and MACROS.search(data):
                    kind = "xacro"
                digest = hashlib.sha256(data).digest()
                if digest not in seen:
                    seen.add(digest)
                    yield path, kind, data


def is_mjcf(data: bytes) -> bool:
    """Whether an `.xml` file is MJCF, by its first tag; others, and what MJCF files include, are passed over."""
    start = BEFORE_THE_ROOT.sub(b"", data[:65536]).lstrip(b"\xef\xbb\xbf \t\r\n")
    return re.match(rb"<mujoco[\s/>]", start) is not None


def packages_in(folders: Sequence[Path]) -> dict[str, list[Path]]:
    """The folders of ROS packages, by the packages' names."""
    found: dict[str, list[Path]] = defaultdict(list)
    for folder in folders:
        for place, inner, names in os.walk(folder):
            inner.sort()
            if "package.xml" in names:
                text = Path(place, "package.xml").read_text(errors="replace")
                name = re.search(r"<name>\s*([\w.-]+)\s*</name>", text)
                found[name[1] if name else Path(place).name].append(Path(place))
    return found


def nearest(packages: Mapping[str, Sequence[Path]], path: Path) -> dict[str, str]:
    """Of several packages of a name the one nearest to a file: as a user would give them with `--package`."""
    above = set(path.parents)
    return {
        name: str(max(places, key=lambda place: sum(parent in above for parent in (place, *place.parents))))
        for name, places in packages.items()
    }


def with_every_link(tree: Tree) -> Tree:
    """The tree with a tip `link NAME` on every link beside its own tips, `tip NAME`."""
    graph = tree.graph
    links = [Tip(f"link {name}", number) for number, name in enumerate(graph.links)]
    tips = [Tip(f"tip {tip.name}", tip.link, tip.tool) for tip in graph.tips]
    every = Graph(graph.links, graph.joints, graph.root, graph.base, (*links, *tips), graph.couplings)
    return replace(tree, graph=every)


def read(path: Path, kind: str, packages: Mapping[str, str]) -> Tree:
    """The tree in a file, its angles as they are written."""
    if kind == "xacro":
        return read_xacro(path, packages=packages, exact=True)
    return robokin.load_tree(path, exact=True)


def judged(path: Path, kind: str, data: bytes, packages: Mapping[str, str], rng: np.random.Generator) -> Case:
    """Read a file and compare it with every peer that takes it."""
    case = Case(path, kind)
    start = time.perf_counter()
    tree = None
    try:
        tree = read(path, kind, packages)
    except InputError as error:
        case.refusal = str(error)
    except Exception as error:  # what no user should see
        case.crash = f"{type(error).__name__}: {error}"
    case.seconds = time.perf_counter() - start
    for peer, make in corpus_peers.peers_of(kind).items():
        try:
            model = make(path, data, packages)
        except Exception as error:
            case.peers_say[peer] = str(error).strip().split("\n")[0][:120] or type(error).__name__
            continue
        case.peers_say[peer] = "takes it"
        if tree is not None:
            try:
                case.differences[peer] = difference(tree, model, rng)
            except corpus_peers.NotComparedError as error:
                case.peers_say[peer] = str(error)
            except (LookupError, ValueError) as error:
                case.peers_say[peer] = f"fails with {type(error).__name__}: {error}"
    if tree is not None:
        case.joints = tree.n
    return case


def difference(tree: Tree, model: Any, rng: np.random.Generator) -> float:
    """The greatest difference of the poses of a tree's links and tips from a peer's, at random joint values."""
    every, greatest = with_every_link(tree), 0.0
    rows = rng.uniform(-1.5, 1.5, (TRIES, tree.n))
    for q, poses in zip(rows, robokin.tip_poses(every, rows), strict=True):
        ours = dict(zip(every.tips, poses, strict=True))
        theirs = model.poses(tree, q)
        both = ours.keys() & theirs.keys()
        if len(both) < min(len(tree.graph.links), 2):
            raise corpus_peers.NotComparedError("has none of the links")
        size = max(1.0, *(float(np.max(np.abs(theirs[name][:3, 3]))) for name in both))
        for name in both:
            gap = float(np.max(np.abs(ours[name] - theirs[name]))) / size
            greatest = max(greatest, gap if np.isfinite(gap) else np.inf)
    return greatest


def reason_of(refusal: str) -> str:
    """The kind of a refusal: its first sentence without names, numbers and places."""
    first = refusal.split("\n")[0]
    first = re.sub(r"^\S+?:\d+:\d+: ", "", first)
    first = re.sub(r"'[^']*'|\"[^\"]*\"", "'…'", first)
    first = re.sub(r"\S*/\S+", "…", first)
    return re.sub(r"\d[\d.,]*", "#", first)[:110]


def report(cases: Sequence[Case], every: bool) -> Iterator[str]:
    """The figures, line by line."""
    yield "        " + "".join(f"{word:>8}" for word in ("files", *OUTCOMES)) + "     worst  compared with"
    for kind in dict.fromkeys(FORMATS.values()):
        group = [case for case in cases if case.kind == kind]
        count = Counter(case.outcome for case in group)
        known = [max(case.differences.values()) for case in group if case.outcome == "agree"]
        peers = Counter(peer for case in group for peer in case.differences)
        those = ", ".join(f"{peer} {number}" for peer, number in peers.most_common())
        figures = "".join(f"{number:>8}" for number in (len(group), *(count[word] for word in OUTCOMES)))
        yield f"{kind:8}{figures}{max(known, default=0.0):>10.1e}  {those}"
    for case in cases:
        if case.outcome in ("crash", "DIFFER"):
            yield f"\n{case.outcome} {case.kind} {case.path}\n  {case.crash or case.differences} {case.peers_say}"
    for kind in dict.fromkeys(FORMATS.values()):
        reasons: dict[str, list[Case]] = defaultdict(list)
        for case in cases:
            if case.kind == kind and case.outcome == "refused":
                reasons[reason_of(case.refusal)].append(case)
        if reasons:
            yield f"\n{kind}: refused because"
        for reason, those_cases in sorted(reasons.items(), key=lambda one: -len(one[1])):
            takers = Counter(p for c in those_cases for p, said in c.peers_say.items() if said == "takes it")
            taken = ", ".join(f"{peer} takes {number}" for peer, number in takers.items())
            yield f"{len(those_cases):>5} {reason}" + (f" ({taken})" if taken else "")
            for case in those_cases[: None if every else 1]:
                yield f"        {case.refusal.splitlines()[0][:300]}"
    alone = [case for case in cases if case.outcome == "alone"]
    if alone and every:
        yield "\nread, and no peer to compare with"
        yield from (f"        {case.path} {case.peers_say}" for case in alone)
    slow = sorted(cases, key=lambda case: -case.seconds)[:3]
    yield "\nslowest: " + "; ".join(f"{1e3 * c.seconds:.0f} ms {c.path.name} ({c.joints} joints)" for c in slow)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.corpora", description=__doc__)
    parser.add_argument("folders", nargs="*", type=Path, help="by default the installed packages")
    parser.add_argument("--every", action="store_true", help="name every file that is refused or read alone")
    parser.add_argument("--format", choices=sorted({*FORMATS.values()}), help="only files of one format")
    parser.add_argument("--seed", type=int, default=SEED)
    asked = parser.parse_args()
    folders = asked.folders or [Path(sysconfig.get_paths()["purelib"])]
    if missing := [str(folder) for folder in folders if not folder.is_dir()]:
        sys.exit(f"found no folder {', '.join(missing)}, expected folders with descriptions")
    print(machine.describe())
    print("peers:", ", ".join(corpus_peers.importable()) or "none but the product of a file's own numbers")
    packages, rng, start = packages_in(folders), np.random.default_rng(asked.seed), time.perf_counter()
    cases = []
    for path, kind, data in descriptions(folders):
        if asked.format in (None, kind):
            given = nearest(packages, path) if kind == "xacro" else {}
            cases.append(judged(path, kind, data, given, rng))
            if sys.stderr.isatty():
                print(f"\r{len(cases)} {str(path)[-70:]:<70}", end="\r", file=sys.stderr, flush=True)
    for line in report(cases, asked.every):
        print(line)
    print(f"{len(cases)} files in {time.perf_counter() - start:.0f} s")


if __name__ == "__main__":
    main()
