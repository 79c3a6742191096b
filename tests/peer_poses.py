"""Poses that Pinocchio and MuJoCo find in `tests/data/descriptions/`, for `tests/data/peer_poses.json`.

    PYTHONPATH=.:SITE-PACKAGES python tests/peer_poses.py [FOLDER]

writes the figures anew, where SITE-PACKAGES has `pinocchio`, `mujoco` and `xacro`. Nothing of robokin finds a pose;
it says in what order the joints' values come. With a FOLDER it finds the poses in the makers' own descriptions of hands
and torsos, `FOLDER/<id>.urdf` or `.xml`, for `tests/data/vendor_trees.json`, whose entries say all but the figures.
"""

from __future__ import annotations

import importlib.metadata
import json
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
from vendor_urdf import meant

import robokin
from benchmarks import corpus_peers
from robokin.formats.mjcf import read_mjcf
from robokin.formats.urdf import read_urdf

FOLDER = Path(__file__).parent / "data" / "descriptions"
PEERS = {"torso.urdf": "pinocchio", "rig.xacro": "pinocchio", "claw.xml": "mujoco", "crane.urdf": "pinocchio"}
FORMATS = {".urdf": "URDF", ".xacro": "xacro", ".xml": "MJCF"}
PACKAGES = {"pinocchio": "pin"}
ROWS = 4
RPY = re.compile(rb'rpy="([^"]*)"')


def recorded(name: str, peer: str) -> dict[str, Any]:
    """The poses of a file's links and sites at some joint values."""
    path = FOLDER / name
    tree = robokin.load_tree(path, exact=True)
    rng = np.random.default_rng(560)
    model = corpus_peers.peers_of(FORMATS[path.suffix])[peer](path, path.read_bytes(), {})
    rows = np.round(rng.uniform(-1.5, 1.5, (ROWS, tree.n)), 3)
    found = []
    for q in rows:
        poses = {place: T[:3].ravel().tolist() for place, T in model.poses(tree, q).items()}
        found.append({"q": dict(zip([joint.name for joint in tree.joints], q.tolist(), strict=True)), "poses": poses})
    version = importlib.metadata.version(PACKAGES.get(peer, peer))
    return {"file": name, "peer": f"{peer} {version}", "rows": found}


def of_a_maker(entry: dict[str, Any], folder: Path) -> None:
    """Renew the figures of an entry of `vendor_trees.json`: a maker's limits, and poses of its tips in its base."""
    (path,) = folder.glob(f"{entry['id']}.*")
    data = path.read_bytes()
    if path.suffix == ".urdf":
        data = RPY.sub(lambda found: b'rpy="%s"' % _meant(found[1].decode()).encode(), data)
    tree = read_mjcf(data, exact=True) if path.suffix == ".xml" else read_urdf(data, "", exact=True)
    model = corpus_peers.peers_of(FORMATS[path.suffix])[entry["peer"].split()[0]](path, data, {})
    limits = {
        joint.name: np.where(np.isfinite(joint.limits), joint.limits, 0.0).tolist() for joint in tree.graph.joints
    }
    entry["limits"] = [limits[name] for name in entry["joints"]]
    rng = np.random.default_rng(560)
    entry["rows"] = []
    for _ in range(ROWS):
        q = dict(zip(entry["joints"], np.round(rng.uniform(*np.transpose(entry["limits"])), 4).tolist(), strict=True))
        poses = model.poses(tree, [q.get(joint.name, 0.0) for joint in tree.joints])
        base = np.linalg.inv(poses[f"link {entry['base']}"])
        tips = {ours: (base @ poses[theirs])[:3].ravel().tolist() for ours, theirs in entry["tips"].items()}
        entry["rows"].append({"q": [*q.values()], "poses": tips})


def _meant(rpy: str) -> str:
    """Angles with those that are multiples of 45 degrees cut in print as these."""
    return " ".join(repr(meant(float(angle))) for angle in rpy.split())


def written(entries: list[dict[str, Any]]) -> str:
    """Entries with a line for each row of figures."""
    lines = []
    for entry in entries:
        head = json.dumps({key: value for key, value in entry.items() if key != "rows"})[:-1]
        rows = ",\n".join(f"   {json.dumps(row)}" for row in entry["rows"])
        lines.append(f' {head}, "rows": [\n{rows}]}}')
    return "[\n" + ",\n".join(lines) + "\n]\n"


def main() -> None:
    if sys.argv[1:]:
        path = FOLDER.parent / "vendor_trees.json"
        entries = json.loads(path.read_text())
        for entry in entries:
            of_a_maker(entry, Path(sys.argv[1]))
        path.write_text(written(entries))
        return
    entries = [recorded(name, peer) for name, peer in PEERS.items()]
    (FOLDER.parent / "peer_poses.json").write_text(written(entries))


if __name__ == "__main__":
    main()
