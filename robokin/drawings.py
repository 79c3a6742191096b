"""Pictures of arms and mechanisms for Python: what `robokin plot` draws, as bytes that a notebook shows."""

from __future__ import annotations

import pathlib
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from robokin.errors import InputError
from robokin.expected import described, expect_choice, expect_finite, expect_flag, expect_kind
from robokin.inverse.joint_paths import Path
from robokin.inverse.solutions import Result
from robokin.model import Mechanism, Robot, Tree, expect_robot
from robokin.model.named_values import plain_joint_values
from robokin.units import Units

if TYPE_CHECKING:
    from robokin.pictures.arm_scene import Scene
    from robokin.pictures.drawn_arm import AskedPostures

KINDS = ("svg", "png", "pdf", "html", "text", "gif")

FRAME = 640
"""Height in pixels of the frame in which a notebook shows a page that turns."""


@dataclass(frozen=True, eq=False)
class Drawing:
    """A picture: `kind` is svg, png, pdf, html, text or gif, `data` the bytes of such a file."""

    kind: str
    data: bytes

    def save(self, path: str | pathlib.Path) -> None:
        """Write the picture to a file, whose name ends with the picture's kind (.txt for text)."""
        file = pathlib.Path(expect_kind(path, (str, pathlib.Path), "path", "the path of a file"))
        ending = ".txt" if self.kind == "text" else f".{self.kind}"
        if file.suffix.lower() != ending:
            raise InputError(f"path: found '{file}', expected a name that ends with {ending}: this is what was drawn")
        file.write_bytes(self.data)

    def __str__(self) -> str:
        """A picture in text; of others a line."""
        return self.data.decode() if self.kind == "text" else repr(self)

    def __repr__(self) -> str:
        """A line: the kind and the size."""
        return f"<{self.kind} picture, {len(self.data)} bytes>"

    def _repr_html_(self) -> str | None:
        if self.kind == "text":
            from robokin.reports.html_pages import html_text

            return html_text(self.data.decode())
        if self.kind != "html":
            return None
        page = escape(self.data.decode(), quote=True)
        return f'<iframe srcdoc="{page}" sandbox="allow-scripts" style="width: 100%; height: {FRAME}px"></iframe>'

    def _repr_svg_(self) -> str | None:
        return self.data.decode() if self.kind == "svg" else None

    def _repr_png_(self) -> bytes | None:
        return self.data if self.kind == "png" else None


def draw(
    what: Robot | Tree | Mechanism | Result | Path,
    q: ArrayLike | None = None,
    kind: str = "svg",
    *,
    frames: bool = False,
    view: tuple[float, float] | None = None,
    units: Units | None = None,
) -> Drawing:
    """A picture of a robot or a tree, of all solutions that `solve_ik` found, of a mechanism, or of a path.

    q: (n,) or (m, n) [rad | m] the configurations of a robot or a tree, of which all but the first are pale; by
    default its pose `home`, else zeros. kind: svg, png, pdf (which need matplotlib), html (a page that turns) or text,
    and of what moves, a mechanism or a path, gif (which needs it, too); a path is not drawn as text.
    `frames` draws a frame after each row of the table; view: azimuth and elevation [°] of the eye. Raises InputError.
    """
    expect_choice(kind, KINDS, "kind")
    eye = None if view is None else _view(view)
    if units is not None:
        expect_kind(units, Units, "units", "units, such as robokin.Units('mm', 'deg')")
    if isinstance(what, Mechanism):
        if q is not None:
            raise InputError("q: is for robots, expected none for a mechanism")
        return Drawing(kind, _mechanism(what, kind, eye, units or what.units))
    from robokin.pictures.picture_files import ENDINGS, MOVING, picture_ending

    if isinstance(what, Path):
        from robokin.pictures.drawn_path import path_picture

        if q is not None or frames:
            raise InputError(f"{'frames' if q is None else 'q'}: is for robots, expected none for a path")
        picture_ending(f"picture.{kind}", "kind", MOVING)
        return Drawing(kind, path_picture(what, units or what.robot.units, kind, view=eye))
    scene, _ = scene_with(what, q, expect_flag(frames, "frames"), eye, units)
    if kind == "text":
        from robokin.pictures.arm_text import arm_text

        return Drawing(kind, arm_text(scene).encode())
    from robokin.pictures.drawn_arm import arm_picture

    picture_ending(f"picture.{kind}", "kind", ENDINGS)
    return Drawing(kind, arm_picture(scene, kind))


def _view(view: Sequence[float]) -> tuple[float, float]:
    what = "azimuth within ±360 and elevation within ±90 [°]"
    azimuth, elevation = expect_finite(view, "view", what, (2,)).tolist()
    if abs(azimuth) > 360.0 or abs(elevation) > 90.0:
        raise InputError(f"view: found {azimuth:g}, {elevation:g}, expected {what}")
    return azimuth, elevation


def scene_with(
    what: Robot | Tree | Result,
    q: ArrayLike | None,
    frames: bool,
    view: tuple[float, float] | None,
    units: Units | None,
) -> tuple[Scene, AskedPostures]:
    """The picture of a robot or a tree at configurations, or with the solutions of a target, and what was asked for."""
    from robokin.pictures.arm import default_configuration
    from robokin.pictures.drawn_arm import AskedPostures, given_postures, scene_of, solved_postures

    robot: Robot | Tree
    if isinstance(what, Result):
        if what.question is None:
            raise InputError("what: this result does not know its robot, expected one of robokin.solve_ik")
        robot = what.question.robot
    else:
        robot = what if isinstance(what, Tree) else expect_robot(what, "what")
    own, name = units or robot.units, ""
    given = [] if q is None else [*_rows(robot, q)]
    if isinstance(what, Result):
        assert what.question is not None
        wanted = solved_postures(what.question, own, given, result=what)
    else:
        if not given:
            home, name = default_configuration(robot)
            given = [home]
        wanted = AskedPostures(given_postures(robot, own, given))
    if not wanted.postures:
        raise InputError(f"what: nothing can be drawn: {what!r}, expected a result with a solution or a q")
    return scene_of(robot, own, wanted, name, view, frames), wanted


def _rows(robot: Robot | Tree, q: ArrayLike) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    values = expect_finite(plain_joint_values(robot, q), "q", f"(n,) or (m, n) finite joint values, n = {robot.n}")
    if values.ndim not in (1, 2) or values.shape[-1] != robot.n or not values.size:
        raise InputError(f"q: found {described(values)}, expected (n,) or (m, n), n = {robot.n}")
    return values.reshape(-1, robot.n)


def _mechanism(mechanism: Mechanism, kind: str, view: tuple[float, float] | None, units: Units) -> bytes:
    from robokin.pictures.drawn_mechanism import check_drawable, motion_to_draw, picture_of
    from robokin.pictures.mechanism_scene import mechanism_scene
    from robokin.pictures.mechanism_text import mechanism_text

    check_drawable(mechanism, None if kind == "text" else f"picture.{kind}", "kind")
    if kind == "text":
        return mechanism_text(mechanism_scene(mechanism, None, None, units, view)).encode()
    moved, _ = motion_to_draw(mechanism)
    return picture_of(mechanism, moved, None, units, f".{kind}", view)
