"""`analyse_workspace`: everything that is said of a robot's workspace, put together."""

from __future__ import annotations

from robokin.errors import InputError
from robokin.expected import expect_choice, expect_flag, expect_number, expect_whole
from robokin.jobs.sequences import KINDS, Kind
from robokin.jobs.stages import stage
from robokin.model import Robot, expect_robot
from robokin.workspace.extremes import extent
from robokin.workspace.measure import REDUNDANT, measurable, measure, structural_length
from robokin.workspace.membership import decided
from robokin.workspace.orientation import dexterity, expect_turnable, notes_of_turns
from robokin.workspace.sizes import Measure
from robokin.workspace.space import space_of
from robokin.workspace.workspace_result import Workspace

SAMPLES = 1 << 17
"""Configurations that the answers are made from unless it is said otherwise."""

BALL = 4.0 / 3.0 * 3.141592653589793
"""Volume of the ball of radius 1."""


def analyse_workspace(
    robot: Robot,
    samples: int = SAMPLES,
    seed: int = 0,
    sampling: Kind = "sobol",
    cores: int | None = None,
    dextrous: bool = False,
    voxel: float | None = None,
) -> Workspace:
    """What the origin of a robot's tool can reach within the joint limits.

    samples: how many configurations or points may be looked at; the bound of the error falls with it. `sampling` is
    kept for who draws samples from the result; sizes always come from even sequences. `dextrous` adds how freely
    the tool can be turned, at places `voxel` [m] apart if it is given. The same answer for a seed on any number
    of `cores` (None: all). Raises InputError for fewer samples than one, an unknown sampling, a robot without joints or
    whose values have no end, and `dextrous` where orientations could only be searched for.

    It is not called `workspace`, as is the package that it comes from.
    """
    robot = expect_robot(robot)
    samples, seed = expect_whole(samples, "samples", 1), expect_whole(seed, "seed", 0)
    expect_choice(sampling, KINDS, "sampling")
    cores = None if cores is None else expect_whole(cores, "cores", 1)
    dextrous = expect_flag(dextrous, "dextrous")
    if voxel is not None:
        voxel = expect_number(voxel, "voxel", "a length [m] greater than 0")
        if voxel <= 0.0:
            raise InputError(f"voxel: found {voxel:g}, expected a length [m] greater than 0")
    space = space_of(robot)
    if dextrous:
        expect_turnable(space)
    stage("bounds")
    bounds, notes, cells = extent(space, seed), [], None
    stage(space.quantity)
    if measurable(space):
        size, cells = measure(space, bounds, samples, seed, cores)
    else:
        notes.append(f"the {space.quantity} of a curved set that more joints reach than it has dimensions is not known")
        size = Measure(float("nan"), float("nan"), "not measured", 0)
    if not decided(space):
        notes.append(REDUNDANT)
    length = structural_length(robot)
    solid = space.dimension == 3 and size.value > 0.0
    freedom = dexterity(space, bounds, size, samples, seed, voxel, cores) if dextrous else None
    notes += notes_of_turns(space, freedom)
    return Workspace(
        space=space,
        samples=samples,
        seed=seed,
        sampling=sampling,
        extent=bounds,
        measure=size,
        structural_length=length,
        length_index=float(length / size.value ** (1.0 / 3.0)) if solid else None,
        volume_index=float(size.value / (BALL * length**3)) if solid and length > 0.0 else None,
        dexterity=freedom,
        notes=tuple(notes),
        cells=cells,
    )
