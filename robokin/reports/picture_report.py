"""What `robokin plot` writes where no picture is asked for: a stick figure in text, or the corners of what is drawn."""

from __future__ import annotations

from collections.abc import Iterator

from robokin.kinematics.forward import forward_kinematics
from robokin.kinematics.tips import tip_poses
from robokin.number_text import show
from robokin.pictures.arm_scene import Scene
from robokin.pictures.drawn_arm import AskedPostures
from robokin.pictures.mechanism_scene import MechanismScene
from robokin.records.envelope import envelope
from robokin.records.picture_records import arms_record, drawn_record
from robokin.records.pose_records import poses_in
from robokin.tables.written_rows import csv_records, written

MOST_TIPS = 12
"""Tips of a tree whose places stand below its picture."""


def arms_written(kind: str, scene: Scene, wanted: AskedPostures) -> Iterator[bytes]:
    """What a picture of arms shows, as text or as plain data."""
    if kind == "table":
        return iter([_arms_page(scene, wanted)])
    document, head = arms_record(scene, wanted), envelope("robot", scene.arm.robot.id, scene.units)
    if "trees" in document:
        trees = document["trees"]

        def tree_csv() -> bytes:
            corners = ((i, k, m, *point) for i, tree in enumerate(trees, 1) for k, line in enumerate(tree["lines"], 1)
                       for m, point in enumerate(line, 1))  # fmt: skip
            return csv_records(["tree", "line", "corner", "x", "y", "z"], corners)

        return written(kind, document, ({**head, **tree} for tree in trees), tree_csv)
    arms = document["arms"]

    def csv() -> bytes:
        corners = ((i, k, *point) for i, arm in enumerate(arms, 1) for k, point in enumerate(arm["points"], 1))
        return csv_records(["arm", "corner", "x", "y", "z"], corners)

    return written(kind, document, ({**head, **arm} for arm in arms), csv)


def _arms_page(scene: Scene, wanted: AskedPostures) -> bytes:
    from robokin.model import Robot
    from robokin.pictures.arm_text import arm_text
    from robokin.reports.page_tables import heading, pairs, render

    robot, units = scene.arm.robot, scene.units
    q = scene.postures[0].q
    if isinstance(robot, Robot):
        poses = {"tool": forward_kinematics(robot, q)}
    else:
        poses = dict(zip(robot.tips[:MOST_TIPS], tip_poses(robot, q), strict=False))
    places = {name: poses_in(T, units)[:3, 3].tolist() for name, T in poses.items()}
    entries = [(name, "  ".join(map(show, place)) + f"  {units.length}") for name, place in places.items()]
    if not isinstance(robot, Robot) and len(robot.tips) > MOST_TIPS:
        entries.append(("…", f"{len(robot.tips)} tips: robokin fk has all"))
    named = [posture for posture in scene.postures if posture.label]
    entries += [(f"{k}", posture.label) for k, posture in enumerate(named, start=1)]
    return render(heading(scene.title, scene.subtitle), "", arm_text(scene), pairs(entries))


def mechanism_written(kind: str, scene: MechanismScene) -> Iterator[bytes]:
    """What a picture of a mechanism shows, as text or as plain data."""
    if kind == "table":
        return iter([_mechanism_page(scene)])
    document = drawn_record(scene)
    links, head = document["links"], envelope("mechanism", scene.mechanism.id, scene.units)

    def csv() -> bytes:
        rows = ((link["name"], joint, *point) for link in links for joint, point in link["points"].items())
        return csv_records(["link", "joint", "x", "y", "z"], rows)

    return written(kind, document, (head | link for link in links), csv)


def _mechanism_page(scene: MechanismScene) -> bytes:
    from robokin.pictures.mechanism_text import mechanism_text
    from robokin.reports.page_tables import heading, pairs, render

    mechanism = scene.mechanism
    moving = [link for link in mechanism.links if link != mechanism.ground]
    entries = [("ground", mechanism.ground), ("links", ", ".join(moving))]
    entries += [("note", scene.note)] if scene.note else []
    return render(heading(mechanism.name, mechanism.space), "", mechanism_text(scene), pairs(entries))
