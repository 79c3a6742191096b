"""The matrices of a robot in symbols as displayed mathematics in LaTeX."""

from __future__ import annotations

from robokin.derivation.symbolic_kinematics import SymbolicKinematics
from robokin.derivation.symbolic_product import Matrix
from robokin.derivation.written_sums import latex, latex_function, latex_name
from robokin.model import Robot
from robokin.number_text import show
from robokin.units import Units


def symbolic_latex(robot: Robot, units: Units, symbolic: SymbolicKinematics) -> str:
    """The matrices as displayed mathematics (amsmath's bmatrix), the symbols' meaning in comments."""
    functions = symbolic.functions

    def drawn(matrix: Matrix) -> str:
        rows = [" & ".join(latex(entry, functions, shown_number) for entry in row) for row in matrix]
        return "\\begin{bmatrix}\n" + " \\\\\n".join(f"  {row}" for row in rows) + "\n\\end{bmatrix}"

    parts = [f"% {robot.name}"]
    parts += [f"\\[\n{_latex_matrix(name)} = {drawn(matrix)}\n\\]" for name, matrix in symbolic.matrices.items()]
    parts += [f"\\[\n{_latex_matrix(name)} = {drawn(matrix)}\n\\]" for name, matrix in symbolic.frames.items()]
    factors = " ".join(_latex_matrix(name) for name in symbolic.matrices)
    parts.append(f"\\[\nT = {factors} = {drawn(symbolic.T)}\n\\]")
    meanings = [
        f"{latex_function(function)} = \\{function.name}({function.argument})" for function in functions.values()
    ]
    meanings += [f"{latex_name(name)} = {text}" for name, text in symbolic.definitions.items()]
    meanings += [f"{latex_name(name)} = {shown_number(value)}" for name, value in symbolic.values.items()]
    rest = f"lengths in {units.length}, angles in {units.angle}"
    return "\n".join([*parts, *(f"% {line}" for line in meanings), f"% {rest}"]) + "\n"


def _latex_matrix(name: str) -> str:
    """`A_{1}`, `T^{0}_{3}`; base and tool by what they are."""
    if name in ("base", "tool"):
        return f"T_{{\\mathrm{{{name}}}}}"
    if name.startswith("T_0_"):
        return f"T^{{0}}_{{{name[4:]}}}"
    return f"A_{{{name[1:]}}}"


def shown_number(value: float) -> str:
    """A number for eyes; a very small one is not shown as 0, which would be another matrix."""
    text = show(value)
    return f"{value:.6g}" if text == "0" and value else text
