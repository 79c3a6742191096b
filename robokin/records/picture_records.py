"""What `robokin plot` says of an arm or a mechanism as plain data: corners, joints, poses."""

from __future__ import annotations

from typing import Any

from robokin.arrays import Array
from robokin.kinematics.forward import forward_kinematics, row_frames
from robokin.kinematics.tips import tip_poses
from robokin.model import Mechanism, Robot, Tree
from robokin.model.joint_units import in_units, joint_factors
from robokin.pictures.arm import body_frames, line_of, lines_of
from robokin.pictures.arm_scene import Posture, Scene
from robokin.pictures.drawn_arm import AskedPostures
from robokin.pictures.mechanism_scene import MechanismScene
from robokin.records.envelope import envelope
from robokin.records.pose_records import pose_records, poses_in
from robokin.units import Units


def arms_record(scene: Scene, wanted: AskedPostures) -> dict[str, Any]:
    """The document of `robokin plot` about an arm or a tree."""
    robot = scene.arm.robot
    if not isinstance(robot, Robot):
        trees = [_tree_record(scene, robot, posture) for posture in scene.postures]
        return envelope("robot", robot.id, scene.units) | {"trees": trees}
    target = None if scene.target is None else poses_in(scene.target.copy(), scene.units).tolist()
    more: dict[str, Any] = {"target": target, "reachable": None, "reason": None}
    if wanted.result is not None:
        more |= {"reachable": wanted.result.reachable, "reason": wanted.result.reason}
    arms = [_arm_record(scene, robot, posture) for posture in scene.postures]
    return envelope("robot", robot.id, scene.units) | more | {"arms": arms}


def _tree_record(scene: Scene, tree: Tree, posture: Posture) -> dict[str, Any]:
    """A tree as a picture has it: its values, the corners of its lines, its joints, the poses of its tips."""
    units, skeleton = scene.units, scene.arm.skeleton
    frames = body_frames(tree, posture.q)
    lines = [(line / units.metres + 0.0).tolist() for line in lines_of(scene.arm, frames)]
    poses = pose_records(poses_in(tip_poses(tree, posture.q), units), units)
    record: dict[str, Any] = {
        "label": posture.label,
        "ghost": posture.ghost,
        "q": in_units(posture.q, joint_factors(tree, units)).tolist(),
        "within_limits": bool(tree.within_limits(posture.q)),
        "lines": lines,
        "joints": [
            _joint_record(body.joint.name, str(body.joint.type), frame, units)
            for body, frame in zip(skeleton.bodies, frames[1:], strict=True)
        ],
        "tips": dict(zip(tree.tips, poses, strict=True)),
    }
    if scene.frames:
        matrices = [(mark.name, poses_in(frames[mark.body] @ mark.T, units).tolist()) for mark in skeleton.links]
        record["frames"] = [{"name": name, "matrix": matrix} for name, matrix in matrices]
    return record


def _joint_record(name: str, kind: str, frame: Array, units: Units) -> dict[str, Any]:
    """A joint by its frame (4, 4) [m]: where it is, and along what."""
    place, axis = frame[:3, 3] / units.metres + 0.0, frame[:3, 2] + 0.0
    return {"name": name, "type": kind, "position": place.tolist(), "axis": axis.tolist()}


def _arm_record(scene: Scene, robot: Robot, posture: Posture) -> dict[str, Any]:
    """An arm as a picture has it: its values, its corners from base to tool, its joints, its pose."""
    units = scene.units
    frames = body_frames(robot, posture.q)
    points = line_of(scene.arm, frames) / units.metres + 0.0
    record: dict[str, Any] = {
        "label": posture.label,
        "ghost": posture.ghost,
        "q": in_units(posture.q, joint_factors(robot, units)).tolist(),
        "within_limits": bool(robot.within_limits(posture.q)),
        "points": points.tolist(),
        "joints": [
            _joint_record(body.joint.name, str(body.joint.type), frame, units)
            for body, frame in zip(scene.arm.skeleton.bodies, frames[1:], strict=True)
        ],
        "pose": pose_records(poses_in(forward_kinematics(robot, posture.q), units)[None], units)[0],
    }  # fmt: skip
    if scene.frames:
        matrices = poses_in(row_frames(robot, posture.q), units).tolist()
        record["frames"] = [{"name": str(i), "matrix": matrix} for i, matrix in enumerate(matrices, start=1)]
    return record


def drawn_record(scene: MechanismScene) -> dict[str, Any]:
    """The document of `robokin plot` about a mechanism."""
    mechanism, units = scene.mechanism, scene.units
    links = [{"name": link, "points": _points(mechanism, link, units)} for link in mechanism.links]
    joints = [
        {"name": joint.name, "type": joint.type, "links": list(joint.links),
         "position": None if joint.at is None else (joint.at / units.metres + 0.0).tolist(),
         "axes": None if joint.axes is None else (joint.axes + 0.0).tolist()}
        for joint in mechanism.joints
    ]  # fmt: skip
    more = {"name": mechanism.name, "space": mechanism.space, "ground": mechanism.ground}
    return envelope("mechanism", mechanism.id, units) | more | {"links": links, "joints": joints}


def _points(mechanism: Mechanism, link: str, units: Units) -> dict[str, list[float]]:
    """Where a link's joints are as assembled, in the units."""
    return {
        joint.name: (joint.at / units.metres + 0.0).tolist()
        for joint in mechanism.joints
        if link in joint.links and joint.at is not None
    }
