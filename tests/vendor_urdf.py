"""The manufacturers' own descriptions of arms, read without this package: URDF to poses, for `tests/data/vendors.json`.

An independent reader: a chain of links and joints, nothing else. Angles within CUT of a multiple of 45 degrees are
taken as meant: 1.5708 and 3.1416 are right angles cut in print.

    python tests/vendor_urdf.py FOLDER

computes the figures of `tests/data/vendors.json` anew from `FOLDER/<id>.urdf`, the file of each entry, with `xacro`
expanded where it is one (the entry's `arguments`). Entries without a file there stay as they are.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

DATA = Path(__file__).parent / "data" / "vendors.json"
CUT = 6e-4
"""How far from a multiple of 45 degrees an angle cut to three decimals may be [rad]; 1.57, 8e-4 off, is as written."""


def meant(angle: float) -> float:
    """The angle, or the multiple of 45 degrees that it is printed for [rad]."""
    whole = round(angle / (math.pi / 4)) * math.pi / 4
    return whole if abs(angle - whole) < CUT else angle


def transform(xyz: str, rpy: str) -> np.ndarray:
    """The pose (4, 4) of an `origin`: R = Rz(yaw) Ry(pitch) Rx(roll)."""
    roll, pitch, yaw = (meant(float(value)) for value in rpy.split())
    T = about([0, 0, 1], yaw) @ about([0, 1, 0], pitch) @ about([1, 0, 0], roll)
    T[:3, 3] = [float(value) for value in xyz.split()]
    return T


def about(axis: Any, angle: float) -> np.ndarray:
    """A rotation (4, 4) about an axis through the origin, by Rodrigues' formula."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    T = np.eye(4)
    T[:3, :3] += math.sin(angle) * K + (1 - math.cos(angle)) * K @ K
    return T


class Urdf:
    """The joints of a URDF by the link that each carries."""

    def __init__(self, text: str) -> None:
        self.joints: dict[str, dict[str, Any]] = {}
        for joint in ElementTree.fromstring(text).findall("joint"):
            parent, child, origin = joint.find("parent"), joint.find("child"), joint.find("origin")
            if parent is None or child is None:
                continue  # a joint of ros2_control
            given = {} if origin is None else origin.attrib
            axis, limit, kind = joint.find("axis"), joint.find("limit"), joint.get("type")
            bounded = limit is not None and kind in ("revolute", "prismatic")
            self.joints[child.attrib["link"]] = {
                "name": joint.get("name"),
                "type": kind,
                "parent": parent.attrib["link"],
                "origin": transform(given.get("xyz", "0 0 0"), given.get("rpy", "0 0 0")),
                "axis": [1, 0, 0] if axis is None else [float(value) for value in axis.attrib["xyz"].split()],
                "limits": [float(limit.get("lower", 0)), float(limit.get("upper", 0))] if bounded else None,
            }

    def path(self, link: str) -> list[dict[str, Any]]:
        """The joints from the root to a link."""
        found: list[dict[str, Any]] = []
        while link in self.joints:
            found.insert(0, self.joints[link])
            link = found[0]["parent"]
        return found

    def moving(self, base: str, tip: str) -> list[dict[str, Any]]:
        """The joints between two links that move, in order."""
        before = [joint["name"] for joint in self.path(base)]
        return [joint for joint in self.path(tip) if joint["type"] != "fixed" and joint["name"] not in before]

    def pose(self, base: str, tip: str, q: Any) -> np.ndarray:
        """The pose (4, 4) of a link in another [m] at joint values (n,) [rad | m]."""
        values = {joint["name"]: value for joint, value in zip(self.moving(base, tip), q, strict=True)}
        return np.linalg.inv(self._world(base, values)) @ self._world(tip, values)

    def _world(self, link: str, values: dict[str, float]) -> np.ndarray:
        T = np.eye(4)
        for joint in self.path(link):
            T = T @ joint["origin"]
            value = values.get(joint["name"], 0.0)
            if joint["type"] == "prismatic":
                step = np.eye(4)
                step[:3, 3] = value * np.array(joint["axis"])
                T = T @ step
            elif joint["type"] != "fixed":
                T = T @ about(joint["axis"], value)
        return T


def quaternion(R: np.ndarray) -> list[float]:
    """w, x, y, z of a rotation (3, 3), by its eigenvector; w is not negative."""
    half = (R - R.T)[[2, 0, 1], [1, 2, 0]]
    K = np.block([[np.array([[np.trace(R)]]), half[None]], [half[:, None], R + R.T - np.trace(R) * np.eye(3)]])
    q = np.linalg.eigh(K)[1][:, -1]
    return [round(float(value), 12) + 0.0 for value in q * (1 if q[0] >= 0 else -1)]


def figures(entry: dict[str, Any], urdf: Urdf) -> dict[str, Any]:
    """Joint limits and poses of an entry's arm [deg, mm], at zero and at four seeded places."""
    joints = urdf.moving(entry["base"], entry["tip"])
    scale = [1e-3 if joint["type"] == "prismatic" else math.pi / 180 for joint in joints]
    limits = [
        None if j["limits"] is None else [round(v / s, 3) for v in j["limits"]]
        for j, s in zip(joints, scale, strict=True)
    ]
    rng = np.random.default_rng(len(joints))
    poses = []
    for q in [np.zeros(len(joints), int), *rng.integers(-150, 151, (4, len(joints)))]:
        T = urdf.pose(entry["base"], entry["tip"], q * np.array(scale)) @ np.array(entry.get("turned", np.eye(4)))
        position = [round(float(value) * 1e3, 8) + 0.0 for value in T[:3, 3]]
        poses.append([q.tolist(), position, quaternion(T[:3, :3])])
    return {"joints": [joint["name"] for joint in joints], "limits": limits, "poses": poses}


def written(entries: list[dict[str, Any]]) -> str:
    """The entries as JSON, a line for each pose."""

    def line(key: str, value: Any) -> str:
        if key == "poses":
            return '"poses": [\n   ' + ",\n   ".join(json.dumps(pose) for pose in value) + "]"
        return f"{json.dumps(key)}: {json.dumps(value, ensure_ascii=False)}"

    return (
        "[\n"
        + ",\n".join(" {" + ",\n  ".join(line(k, v) for k, v in entry.items()) + "}" for entry in entries)
        + "\n]\n"
    )


def main(folder: Path) -> None:
    entries = json.loads(DATA.read_text(encoding="utf-8"))
    for entry in entries:
        path = folder / f"{entry['id']}.urdf"
        if path.is_file():
            entry.update(figures(entry, Urdf(path.read_text(encoding="utf-8"))))
    DATA.write_text(written(entries), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
