"""What a robot is mostly asked, as methods: each is the package's function of the same name with the robot in front."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from robokin.arrays import Array


class RobotMethods:
    """The package's functions as methods. They are in rooms above this one, and asked by the package's own face."""

    def fk(self, q: ArrayLike) -> Array:
        """Poses (..., 4, 4) [m] at joint values q: (..., n) [rad | m]; see `robokin.forward_kinematics`.

        Raises InputError.
        """
        import robokin

        return robokin.forward_kinematics(self, q)  # type: ignore[arg-type]

    def ik(self, T: ArrayLike, **options: Any) -> Any:
        """All solutions for a pose T: (4, 4) [m], or for (m, 4, 4); see `robokin.solve_ik` and its options.

        Raises InputError.
        """
        import robokin

        return robokin.solve_ik(self, T, **options)  # type: ignore[arg-type]

    def jacobian(self, q: ArrayLike, frame: Any = "base") -> Array:
        """The Jacobian (..., 6, n) at joint values q: (..., n) [rad | m]; see `robokin.jacobian`.

        Raises InputError.
        """
        import robokin

        return robokin.jacobian(self, q, frame)  # type: ignore[arg-type]

    def plot(self, q: ArrayLike | None = None, kind: str = "html", **options: Any) -> Any:
        """A picture at joint values q: (n,) or (m, n) [rad | m], which a notebook shows; see `robokin.draw`.

        Raises InputError.
        """
        import robokin

        return robokin.draw(self, q, kind=kind, **options)  # type: ignore[arg-type]

    @property
    def table(self) -> Any:
        """The table as `robokin show` prints it: `len`, an index gives a row; a notebook shows it, `print` too."""
        from importlib import import_module

        return import_module("robokin.table_view").TableView(self)

    def to_yaml(self) -> str:
        """The description of the robot as YAML, which `robokin.load` reads again."""
        from importlib import import_module

        text: str = import_module("robokin.formats.written_robot").written(self)
        return text

    @classmethod
    def from_dh(
        cls,
        table: str | ArrayLike,
        *,
        types: str | None = None,
        convention: str | None = None,
        length: str | None = None,
        angle: str | None = None,
        name: str = "my arm",
        values: Any = None,
    ) -> Any:
        """The robot of a Denavit-Hartenberg table: table: (n, 4) [rad, m], or a text; see `robokin.from_table`.

        Raises InputError.
        """
        import robokin

        return robokin.from_table(
            table, types=types, convention=convention, length=length, angle=angle, name=name, values=values
        )
