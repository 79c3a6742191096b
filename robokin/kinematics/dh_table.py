"""One chain in another convention: a standard or a modified Denavit-Hartenberg table, or frames.

Between the motions of two joints in a row stands a constant step C. Every such step is

    C = Rot(z, theta) Trans(0, 0, d) · Trans(a, 0, 0) Rot(x, alpha) · Trans(0, 0, e) Rot(z, phi)

along and about the common normal of the two axes. The first two factors belong to the joint before it, the middle two
are the link, and the last two let the motion of the next joint pass, so that they become a part of its own step. A
standard and a modified table hold the same numbers: they only part the rows at other places.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError, Note, shown
from robokin.expected import expect_choice
from robokin.kernel.chain import chain_of, chain_size
from robokin.kernel.frames import pose
from robokin.kinematics.common_normal import NormalStep
from robokin.kinematics.round_cells import SAME, round_angle, rounded_cells
from robokin.kinematics.table_cells import NEGLIGIBLE, TableCells, cells_of, constant_steps
from robokin.model import CoupledRobot, Joint, JointType, Robot, expect_robot
from robokin.model.graph import NO_LIMITS
from robokin.model.robot import Convention, row_constants
from robokin.spatial import exact

CONVENTIONS = ("standard", "modified", "frames")


def to_convention(robot: Robot, convention: Convention) -> Robot:
    """The same robot in another convention: `standard`, `modified` or `frames`.

    Every pose at every q: (n,) [rad | m] stays as it is, to 1e-12 of the arm's size. Names, limits, poses, senses,
    units and zeros of the joints are kept. Between standard and modified only a and alpha change their rows. From
    frames there are many tables; this one has a ≥ 0 and d = 0 where axes are parallel, a slide's axis lies where the
    description puts it, and fixed rows become a part of the others. What a table cannot hold stands in `base` and
    `tool`. Axes that are parallel to 1e-9 rad are taken as parallel, and a note says by how much they were off. A robot
    that is in the convention already is returned as it is.

    Raises InputError for axes that are so nearly parallel that the numbers of a table would have no meaning; frames
    hold them. Raises InputTypeError for what is no robot.
    Source: J. Denavit and R. S. Hartenberg, A kinematic notation for lower-pair mechanisms based on matrices,
    J. Applied Mechanics 22, 1955; modified tables as J. J. Craig, Introduction to Robotics, 1986, has them.
    """
    robot = expect_robot(robot)
    expect_choice(convention, CONVENTIONS, "convention")
    if robot.convention == convention:
        return robot
    if isinstance(robot, CoupledRobot):
        return _coupled(robot, convention)
    if convention == "frames":
        made = _frames(robot)
    elif robot.convention == "frames":
        made = _table(robot, convention)
    else:
        made = _to_modified(robot) if convention == "modified" else _to_standard(robot)
    return replace(made, convention=convention)


def _coupled(robot: CoupledRobot, convention: Convention) -> Robot:
    """The same of joints that hang on each other: what moves them does not change, nor what helical ones advance."""
    rows = tuple(replace(row, pitch=0.0, motion_limits=NO_LIMITS) for row in robot.rows)
    plain = Robot(
        robot.name, rows, robot.convention, robot.id, robot.description, robot.source, robot.units, robot.parameters,
        robot.base, robot.tool, texts=robot.texts, notes=robot.notes,
    )  # fmt: skip
    made = to_convention(plain, convention)
    moving = iter(row for row in robot.rows if row.moves)
    whole = []
    for row in made.rows:
        own = next(moving) if row.moves else row
        whole.append(replace(row, pitch=own.pitch, motion_limits=own.motion_limits))
    return replace(
        robot,
        rows=tuple(whole),
        convention=convention,
        parameters=made.parameters,
        base=made.base,
        tool=made.tool,
        texts=made.texts,
        notes=made.notes,
    )


def _to_modified(robot: Robot) -> Robot:
    """A standard table as a modified one: a and alpha of a row stand in the next row, those of the last in the tool."""
    before = [(0.0, 0.0), *((row.a, row.alpha) for row in robot.rows)]
    texts = [(), *(row.texts for row in robot.rows)]
    return _shifted(robot, before[:-1], texts[:-1], tool=exact(_link(*before[-1]) @ robot.tool))


def _to_standard(robot: Robot) -> Robot:
    """A modified table as a standard one: a and alpha of the first row stand in the base.

    Where the tool is no more than a length along x and a turn about it, those are the last row's.
    """
    first = robot.rows[0]
    after = [*((row.a, row.alpha) for row in robot.rows[1:]), (0.0, 0.0)]
    texts = [*(row.texts for row in robot.rows[1:]), ()]
    a, alpha = float(robot.tool[0, 3]), math.atan2(robot.tool[2, 1], robot.tool[1, 1])
    tool = robot.tool
    if not robot.texts and float(np.max(np.abs(_link(a, alpha) - tool))) <= NEGLIGIBLE:
        after[-1], tool = (a, round_angle(alpha)), np.eye(4)
    return _shifted(robot, after, texts, base=exact(robot.base @ _link(first.a, first.alpha)), tool=tool)


def _shifted(
    robot: Robot,
    links: list[tuple[float, float]],
    texts: list[tuple[tuple[str, str], ...]],
    base: Array | None = None,
    tool: Array | None = None,
) -> Robot:
    """The robot with other cells a, alpha in its rows, and what is written in them, and with another base or tool."""
    own, moved = ("theta", "d", "offset"), ("a", "alpha")
    rows = tuple(
        replace(
            row,
            a=a,
            alpha=alpha,
            texts=(*(one for one in row.texts if one[0] in own), *(one for one in written if one[0] in moved)),
        )
        for row, (a, alpha), written in zip(robot.rows, links, texts, strict=True)
    )
    ends = {"base": robot.base if base is None else base, "tool": robot.tool if tool is None else tool}
    same = {name for name, T in ends.items() if np.array_equal(T, getattr(robot, name))}
    kept = tuple(one for one in robot.texts if one[0].split()[0] in same)
    return replace(robot, rows=rows, texts=kept, base=ends["base"], tool=ends["tool"])


def _link(a: float, alpha: float) -> Array:
    """Trans(a, 0, 0) Rot(x, alpha): (4, 4)."""
    return NormalStep(0.0, 0.0, a, alpha).link()


def _frames(robot: Robot) -> Robot:
    """The robot as frames: where a joint's own frame stands in that of the joint before it."""
    if not robot.n:
        return _still(robot)
    steps = constant_steps(robot)
    origins = [exact(step) for step in steps]
    rows = tuple(
        Joint(
            joint.name,
            joint.type,
            offset=joint.offset,
            limits=joint.limits,
            origin=origin,
            axis=np.array([0.0, 0.0, 1.0]),
            sense=joint.sense,
        )
        for joint, origin in zip(robot.joints, origins[:-1], strict=True)
    )
    return replace(robot, rows=rows, tool=exact(origins[-1] @ robot.tool), texts=(), parameters={})


def _still(robot: Robot) -> Robot:
    """A robot without joints: one fixed row that does nothing."""
    T = np.eye(4)
    for row in robot.rows:
        before, after = row_constants(row, robot.convention)
        T = T @ before @ after
    row = Joint(robot.rows[0].name if robot.rows else "1", JointType.FIXED)
    return replace(robot, rows=(row,), base=exact(robot.base @ T), texts=(), parameters={})


def _table(robot: Robot, convention: Convention) -> Robot:
    """The robot of frames as a table."""
    if not robot.n:
        return _still(robot)
    size = chain_size(chain_of(robot))
    cells = cells_of(robot, convention, size)
    exactly = _robot_of(robot, cells, convention)
    q = _configurations(robot, size)
    wanted = pose(chain_of(robot), q)
    rounded = _robot_of(robot, rounded_cells(cells, robot, size), convention)
    allowed = SAME * size + 8.0 * robot.n * cells.tilt * size
    best = rounded if _deviation(rounded, q, wanted) <= allowed / 4.0 else exactly
    off = _deviation(best, q, wanted)
    if off > allowed:
        raise InputError(
            f"the {convention} table of {shown(robot.name)} would be off by {off:.1g} m, expected axes that are either "
            "parallel or clearly not; convention frames holds them"
        )
    if cells.tilt > SAME:
        said = f"axes {cells.tilt:.1g} rad from parallel are taken as parallel; the poses are off by {off:.1g} m"
        return replace(best, notes=(*robot.notes, Note(said)))
    return best


def _configurations(robot: Robot, size: float) -> Array:
    """(s, n) [rad | m] configurations at which tables are compared: some turns, and slides up to twice the arm's size.

    They are always the same.
    """
    q = np.vstack([np.zeros(robot.n), np.random.default_rng(0).uniform(-2.0, 2.0, (6, robot.n))])
    return np.where(robot.revolute, q, size * q)


def _deviation(robot: Robot, q: Array, wanted: Array) -> float:
    """How far [m], or in the arm's size where it turns, poses of a robot are from others (s, 4, 4)."""
    chain = chain_of(robot)
    off = np.abs(pose(chain, q) - wanted)
    return float(max(np.max(off[:, :3, 3]), chain_size(chain) * np.max(off[:, :3, :3])))


def _robot_of(robot: Robot, cells: TableCells, convention: Convention) -> Robot:
    """The robot with a table of these numbers."""
    rows = []
    links = [cells.link, *((step.a, step.alpha) for step in cells.steps)]
    for i, (joint, step) in enumerate(zip(robot.joints, cells.steps, strict=True)):
        a, alpha = links[i] if convention == "modified" else links[i + 1]
        turns = joint.type is JointType.REVOLUTE
        rows.append(
            Joint(
                joint.name,
                joint.type,
                theta=0.0 if turns else step.theta,
                d=step.d if turns else 0.0,
                a=a,
                alpha=alpha,
                offset=_offset(joint.offset, step.theta) if turns else joint.offset + step.d,
                limits=joint.limits,
                sense=joint.sense,
            )
        )
    return replace(
        robot, rows=tuple(rows), convention=convention, base=cells.base, tool=cells.tool, texts=(), parameters={}
    )


def _offset(own: float, more: float) -> float:
    """The offset [rad] of a turning joint, within half a turn where anything is added to its own."""
    if more == 0.0:
        return own
    total = math.remainder(own + more, 2.0 * math.pi)
    return math.pi if total <= -math.pi + NEGLIGIBLE else round_angle(total)
