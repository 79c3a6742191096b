"""The native kernel's functions: see native/module.c.

Only robokin calls them, with positions and with arrays of doubles; SI and radians, and "size" where values are
divided by a chain's length. A handle is opaque: `chain`, `form`, `signs`, `elimination` and `swivel` make them.
Joint values of blocks are rows (m, n) [rad | size], targets (m, 4, 4) [m]. A wrong argument ends in TypeError,
ValueError or IndexError.
"""

from collections.abc import Callable
from typing import Any

from robokin.arrays import Array, Flags, Index

interface: int
"""What the functions are called with; another number is another build's."""

most_joints: int
"""Joints of a chain at most."""

most_moved: int
"""Joints of a chain that Newton's steps are for, at most."""

most_slots: int
"""Registers of a tape at most."""

most_roots: int
"""Candidates of a closed form at most."""

sources: str
"""The digest of the C sources that it was made of (`hatch_build.digest`)."""

# The kernel itself, and chains: module.c.

def with_arrays() -> None:
    """Let the functions of arrays work: numpy is there from now on. Raises ImportError for another numpy."""

def instructions(name: str | None = ..., /) -> str:
    """The vector instructions in use, "base" or "avx2"; another set from now on if it is named."""

def chain(constants: Array, revolute: Array, offsets: Array, /) -> object:
    """A chain's handle, of constants (n + 1, 4, 4) [m] and, for each joint, whether it turns and its offset (n,)."""

def plain_chain(constants: tuple[float, ...], revolute: tuple[float, ...], offsets: tuple[float, ...], /) -> object:
    """The same of plain numbers, without numpy."""

def pose(chain: object, q: Array, out: Array = ..., /) -> Array:
    """The tool's poses (..., 4, 4) [m] at joint values q (..., n) [rad | m]."""

def plain_pose(chain: object, q: tuple[float, ...], /) -> tuple[float, ...]:
    """The first twelve numbers of the tool's pose, without numpy."""

def pose_at_once(robot: object, q: Any, /) -> Array | None:
    """The tool's poses of a robot that keeps its chain; None for arguments that Python is to look at."""

def frames(chain: object, q: Array, out: Array = ..., /) -> Array:
    """The frames that joints start from, and the tool's (..., n + 1, 4, 4) [m]."""

def jacobian(chain: object, q: Array, size: float, tool: bool, out: Array = ..., /) -> Array:
    """Jacobians (..., 6, n), lengths divided by size, in the base's directions or in the tool's."""

def jacobian_at_once(robot: object, q: Any, /) -> Array | None:
    """Jacobians of a robot that keeps its chain, by metres in the base's directions; None as of `pose_at_once`."""

def errors(chain: object, T: Array, q: Array, size: float, /) -> tuple[Array, Array]:
    """What joint values lack of their targets (..., 6) [size, rad], and its Jacobians (..., 6, n)."""

# Closed forms, and the signs that name postures: closed_forms.c.

def form(
    chain: object,
    links: Array,
    sizes: Array,
    tape: Array,
    constants: Array,
    leaves: Array,
    levels: float,
    limits: Array,
    /,
) -> object:
    """A closed form's handle: its loop's first and last link, unit and size, its tape, and limits (6, 7)."""

def solution(
    form: object, T: Array, limits: bool, wish: Array | None, elimination: object | None, /
) -> tuple[Array, Array, int, int, float] | None:
    """Rows q, position, angle, inside, equivalents (k, 10) for one target, T as it was, and the number of
    candidates, of solutions within the limits, and of those with their full turns; None where Python is to look at
    it.
    """

def solutions(
    form: object,
    T: Array,
    limits: bool,
    wish: Array | None,
    elimination: object | None = ...,
    most: int | None = ...,
    tables: tuple[Flags, Index, Index, Index, Index, Array, Array, Array, Flags] = ...,
    pattern: Array | None = ...,
    /,
) -> tuple[Flags, Index, Index, Array, Array, Array, Flags] | None:
    """Fill a batch's tables (`robokin.inverse.batch_tables`) for targets, where joints are held with the values of
    `pattern` (n,), which are no numbers elsewhere; without the last four new tables are handed over, but for how many
    candidates and solutions within the limits there were.
    """

def roots(form: object, elimination: object | None, /) -> int:
    """How many rows of its tables a target's answer takes."""

def signs(chain: object, size: float, tape: Array, constants: Array, places: Array, /) -> object:
    """A handle of the signs that name an arm's postures, of a tape and the registers (k, 2) where they stand."""

def sides(signs: object, q: Array, /) -> Index:
    """The signs of configurations q (s, 6) [rad | m] as the bits of a number each."""

def rigid(T: Array, /) -> bool:
    """Whether all of (..., 4, 4) are rigid poses to the last digits."""

# Arms without a closed form: elimination.c.

def elimination(chain: object, numbers: Array, /) -> object:
    """A prepared elimination's handle, of what is put together in `robokin.inverse.elimination.native_elimination`."""

def eliminated(elimination: object, T: Array, /) -> tuple[Array, Array]:
    """Of each target candidates, complex and real solutions and poses next door (m, 4); and of each real solution q,
    position and angle (s, 8).
    """

def candidates(elimination: object, closing: Array, /) -> tuple[Array, Array, Array]:
    """Of loops closed by (m, 4, 4) the number of candidates (m, 2), the real ones (s, 6), one of each complex pair
    (t, 12).
    """

# Arms with a spherical shoulder and wrist: swivel_forms.c.

def swivel(chain: object, numbers: Array, limits: Array, equations: Array, /) -> object:
    """An arm's handle, of what is put together in `robokin.inverse.self_motion.native_swivel`."""

def swivel_solution(arm: object, T: Array, most: int, /) -> tuple[Array, Array, Index, int, int] | None:
    """Rows q, position, angle, curve (k, 10) for one target (4, 4), pieces of curves (p, 4), the joints that move
    along each curve as bits, and how many solutions close and are within the limits; None where Python is to look at
    it.
    """

def swivel_solutions(
    arm: object, T: Array, most: int, tables: tuple[Flags, Index, Index, Index, Index, Array, Array, Array, Flags], /
) -> None:
    """Fill a batch's tables for targets, `most` rows of each."""

# Newton's steps: descents.c.

def descended(
    chain: object, T: Array, far: Array, x: Array, size: float, low: Array, high: Array, steps: int, /
) -> tuple[Array, Array]:
    """Values (m, n) after steps from x towards targets within low and high (n,), and errors (m, 6); far (m,): how
    long slides are [size], at least 1.
    """

def finely_closed(
    chain: object,
    T: Array,
    q: Array,
    error: Array,
    size: float,
    steps: int,
    longest: float,
    zero: float,
    enough: float,
    /,
) -> tuple[Array, Array]:
    """Values (m, n) and errors (m, 6) after the last steps towards solutions where the Jacobian may have no inverse."""

def followed_rows(
    chain: object,
    T: Array,
    x: Array,
    ahead: Array,
    limits: Array,
    size: float,
    opened: int,
    spare: bool,
    listed: bool,
    /,
) -> tuple[int, Array, Array]:
    """How many of a path's targets were followed from x (1, n), their rows (m, n), and the last move (1, n); limits
    (4, n).
    """

def gone_down(
    chain: object,
    T: Array,
    x: Array,
    size: float,
    low: Array,
    high: Array,
    weight: Array,
    steps: int,
    still: float,
    least: float,
    /,
) -> tuple[Array, Array]:
    """Where ways down from x end (m, n), and half the squared distance and 1 - cos of the angle there (m, 2); T by
    columns (m, 12), limits (m, n) or (1, n), weight (m,) of the angle.
    """

def turned(
    chain: object, T: Array, x: Array, size: float, low: Array, high: Array, steps: int, /
) -> tuple[Array, Array]:
    """Values (m, n) that keep the position and are turned least from the target, and what is left as of `gone_down`."""

def corrected(
    chain: object,
    T: Array,
    normals: Array,
    extra: int,
    most: Array,
    x: Array,
    size: float,
    settled: float,
    zero: float,
    /,
) -> tuple[Array, Array, Array]:
    """Values (m, n) back on curves of solutions, the greatest part of the error left (m,), and the Jacobians (m, 6,
    n); normals (m, extra, n): directions along which x keeps its place, most (m,): steps of each.
    """

def advanced(
    chain: object,
    T: Array,
    most: Array,
    low: Array,
    high: Array,
    state: Array,
    closed: Array,
    left: Array,
    size: float,
    plain: float,
    /,
) -> tuple[Array, Array, Array, Array, Array]:
    """Fronts of curves moved on (`robokin.inverse.self_motion.fronts`): their state, which curves are closed, steps
    that are left, which fronts wait for Python, and the points passed (p, 1 + 2 n).
    """

def shortest(A: Array, b: Array, zero: float, /) -> Array:
    """The shortest solutions (m, n) of A (m, r, n) dx = b (m, r), singular values up to `zero` left out."""

def least_values(J: Array, /) -> Array:
    """The least singular values (m,) of Jacobians (m, 6, n)."""

def refined(loop: object, closing: Array, values: Array, steps: int, /) -> tuple[Array, Array]:
    """Values (m, 6) after steps on loops closed by (m, 4, 4), and what they lack (m, 2)."""

def complex_refined(loop: object, closing: Array, values: Array, steps: int, longest: float, /) -> tuple[Array, Array]:
    """The same of complex values, real and imaginary parts in turn: (m, 12), closing (m, 32), and residuals (m,)."""

def tracked(loop: object, start: Array, target: Array, bend: Array, values: Array, /) -> tuple[Array, Array]:
    """Solutions (m, 12) followed from start to target, points of the homotopy (m, 14), and u, speed and whether the
    path is lost (m, 3); bend (m, 2).
    """

# Curves that were followed: curves.c.

def passes(
    chain: object,
    size: float,
    T: Array,
    points: Array,
    tangents: Array,
    counts: Array,
    x: Array,
    ways: Array,
    pairs: Array,
    /,
) -> Array:
    """Whether curves at T (c, 4, 4), of so many points each, pass through configurations x (m, n), for pairs (p, 2)
    of both: 0, 1, or 2 along the ways (m, n).
    """

def pieces_within(
    chain: object,
    size: float,
    T: Array,
    points: Array,
    tangents: Array,
    counts: Array,
    limits: Array,
    curves: Array,
    /,
) -> tuple[Array, Array]:
    """The pieces of curves within limits (6, n), each its curve, whether it is whole, and its points' number (p, 3),
    and these points (k, n); curves (c, 1 + 2 n): whether each is closed, its full turns, and which joints move.
    """

def spread(x: Array, move: Array, most: int, preferred: Array | None, /) -> Index:
    """The places of `most` of configurations x (n, m), each the farthest from those before, the first of the least
    `move` (m,); preferred (m,) is added to how far one is.
    """

# Which solutions are told apart, and in which order they stand: told_apart.c.

def each_once(turning: Array, weights: Array, index: Index, values: Array, apart: Array, compared: int, /) -> Flags:
    """(s,) true for one of those complex values (s, 12) of a target that are nearer than `apart` (s,)."""

def arranged(
    index: Index,
    q: Array,
    off: Array,
    turning: Array,
    size: float,
    cells: Array,
    weights: Array,
    thresholds: tuple[float, float, float, float],
    /,
) -> tuple[Array, Index, Index, Index, int, int, int]:
    """Configurations (m, n) with angles in [-pi, pi], their order without equal ones, the targets of equal and of
    close ones, and how many entries of each of these three count.
    """

def regular(loop: object, values: Array, needed: Array, /) -> Array:
    """(m,) 1 where the loop's singular values at (m, 12) exceed what is needed, 0 where not, -1 where that is not
    told.
    """

# Solutions as objects: solution_objects.c.

def solution_objects(
    kind: type,
    name: Callable[[int], str],
    table: Array,
    joints: int,
    free: Any,
    rows: list[int] | None,
    within: bool,
    pattern: Array | None,
    first: int,
    /,
) -> tuple[Any, ...]:
    """Objects of a class, of a table's rows: see `robokin.inverse.solutions.named_later`."""

# Numbers as text: number_text.c.

def rows_in(text: bytes, separator: bytes, kinds: bytes, /) -> tuple[Array, list[list[str]], bool] | None:
    """The numbers (m, k) of lines, the cells that go through, and whether a number has a point; None for what is not
    plain.
    """

def text_of_rows(table: Array, /) -> bytes:
    """A line for each row (m, k), numbers as short as they can be and with commas between."""
