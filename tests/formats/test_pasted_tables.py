"""Tables as pages print them become descriptions: what is printed is what is read, and what is open is said."""

from __future__ import annotations

import math

import numpy as np
import pytest

import robokin
from robokin.cli.written_forms import written_form
from robokin.errors import InputError
from robokin.formats.library import library_names, load_any
from robokin.formats.pasted_description import Wishes, described_table
from robokin.formats.read import read_text
from robokin.model import Robot


def library_tables():
    """The library's robots that are written as a table of turning and sliding joints."""
    for name in library_names():
        loaded = load_any(name)
        table = type(loaded) is Robot and loaded.convention in ("standard", "modified") and loaded.n
        if table and not any(row.pitch for row in loaded.rows):
            yield name


TABLES = [*library_tables()]


def same(one, other, seed, tolerance=1e-9):
    """Whether two robots have the same poses at random configurations."""
    assert one.n == other.n and one.revolute.tolist() == other.revolute.tolist()
    q = np.random.default_rng(seed).uniform(-3.0, 3.0, (20, one.n))
    size = 1.0 + np.abs(robokin.forward_kinematics(one, q)[:, :3, 3]).max()
    difference = robokin.forward_kinematics(one, q) - robokin.forward_kinematics(other, q)
    assert np.abs(difference).max() < tolerance * size


@pytest.mark.parametrize("kind", ["markdown", "latex"])
@pytest.mark.parametrize("name", TABLES)
def test_what_convert_writes_is_read_back(name, kind):
    robot = robokin.load(name)
    text = written_form(robot, robot.units, kind).decode()
    made = described_table(text, Wishes(name))
    other = read_text(made.text)
    same(robot, other, 1, 2e-5)  # tables have six digits
    assert other.convention == robot.convention
    finite = np.isfinite(robot.limits)
    assert np.allclose(other.limits[finite.all(axis=1)], robot.limits[finite.all(axis=1)], atol=2e-5, rtol=1e-5)


HEADS = {
    "theta": ["θ", "θᵢ", "theta", "θ_i", "$\\theta_i$", "Joint angle θ", "Theta_i", "θi [{a}]", "ϑ"],
    "d": ["d", "dᵢ", "d_i", "$d_i$", "Link offset d", "d [{l}]", "d (mm)"],
    "a": ["a", "aᵢ", "a_i", "$a_i$", "Link length", "a [{l}]"],
    "alpha": ["α", "αᵢ", "alpha", "α_i", "$\\alpha_{i}$", "Twist α", "alpha [{a}]"],
}


class Printer:
    """Prints a table of numbers in a style that a seed chooses."""

    def __init__(self, rng):
        self.rng = rng

    def one(self, *choices):
        return choices[self.rng.integers(len(choices))]

    def minus(self, text):
        return text.replace("-", self.dash)

    def angle(self, degrees, tex):
        if self.pi:
            parts = {0: "0", 90: "π/2", -90: "-π/2", 180: "π", 45: "π/4", -45: "-π/4", 30: "π/6", 60: "π/3"}
            text = parts[degrees]
            if tex:
                text = text.replace("π/2", "\\frac{\\pi}{2}").replace("π", "\\pi ")
        else:
            sign = "^\\circ" if tex else self.one("°", "º", "°")
            text = f"{degrees}{sign}"
        return f"${text}$" if tex else self.minus(text)

    def table(self, rows, order):
        rng = self.rng
        self.pi, self.dash = bool(rng.integers(2)), self.one("-", "−", "–")
        style = self.one("tex", "markdown", "tabs", "csv", "semicolons", "wide", "box")
        tex = style == "tex"
        star = bool(rng.integers(2))
        names = {"tex": (["$\\theta_{%d}", "$q_%d"], ["$d_{%d}", "$q_{%d}"])}.get(
            style, (["θ%d", "θ_%d", "q%d", "theta%d", "θ₍%d"[:1] + "%d"], ["d%d", "d_%d", "q%d"])
        )
        turn, slide = self.one(*names[0]), self.one(*names[1])
        lines = []
        for k, row in enumerate(rows, start=1):
            cells = {"number": str(k)}
            for cell in ("theta", "alpha"):
                cells[cell] = self.angle(row[cell], tex)
            for cell in ("d", "a"):
                cells[cell] = f"${row[cell]}$" if tex else self.minus(str(row[cell]))
            cell, variable = ("theta", turn % k) if row["type"] == "R" else ("d", slide % k)
            shift = cells[cell].strip("$")
            variable += ("^*" if tex else "*") * star
            if row[cell] != 0:
                space = self.one("", " ")
                sign = "" if shift[0] in "-−–" else "+"
                variable += f"{space}{sign}{shift}" if sign else f"{space}{shift[0]}{space}{shift[1:]}"
            cells[cell] = variable + ("$" if tex else "")
            lines.append([cells[name] for name in order])
        heads = []
        for name in order:
            head = self.one("i", "Link", "", "#") if name == "number" else self.one(*HEADS[name])
            head = head.replace("{l}", "mm").replace("{a}", "rad" if self.pi else "deg")
            heads.append(head if tex else head.replace("$", "").replace("\\", "").replace("{i}", "i"))
        grid = [heads, *lines]
        return self.printed(style, grid)

    def printed(self, style, grid):
        if style == "tex":
            body = " \\\\ \\hline\n".join(" & ".join(row) for row in grid)
            return f"\\begin{{tabular}}{{|{'c|' * len(grid[0])}}}\n\\hline\n{body} \\\\\n\\hline\n\\end{{tabular}}\n"
        if style == "markdown":
            rule = "|" + "---|" * len(grid[0])
            lines = ["| " + " | ".join(row) + " |" for row in grid]
            return "\n".join([lines[0], rule, *lines[1:]])
        if style == "box":
            lines = ["│ " + " │ ".join(row) + " │" for row in grid]
            return "\n".join(["┌────┬───┐", lines[0], "├────┼───┤", *lines[1:], "└────┘"])
        if style == "wide":
            grid = [[cell or "." for cell in row] for row in grid]
            return "Table 2: the arm\n\n" + "\n".join("   ".join(cell.ljust(12) for cell in row) for row in grid)
        separator = {"tabs": "\t", "csv": ",", "semicolons": ";"}[style]
        return "\n".join(separator.join(row) for row in grid)


@pytest.mark.parametrize("seed", range(200))
def test_a_table_in_any_style_is_the_robot_that_it_prints(seed):
    rng = np.random.default_rng(seed)
    rows = [
        {
            "type": "RRRP"[rng.integers(4)],
            "theta": int(rng.choice([0, 0, 90, -90, 180])),
            "d": float(rng.choice([0.0, 105.5, 400.0, -30.0])),
            "a": float(rng.choice([0.0, 250.0, 17.25, -20.32])),
            "alpha": int(rng.choice([0, 90, -90, 180, 45, -45])),
        }
        for _ in range(rng.integers(1, 8))
    ]
    order = [*rng.permutation(["theta", "d", "a", "alpha"])]
    order.insert(0, "number")
    text = Printer(rng).table(rows, order)
    angle = math.pi / 180.0
    made = described_table(text, Wishes("arm", length="mm"))
    robot = read_text(made.text)
    assert made.types == "".join(row["type"] for row in rows), text
    q = rng.uniform(-3.0, 3.0, len(rows))
    T = np.eye(4)
    for row, value in zip(rows, q, strict=True):
        turns = row["type"] == "R"
        theta, d = row["theta"] * angle + value * turns, row["d"] / 1000.0 + value * (not turns)
        a, alpha = row["a"] / 1000.0, row["alpha"] * angle
        c, s, ca, sa = math.cos(theta), math.sin(theta), math.cos(alpha), math.sin(alpha)
        T = T @ np.array([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]])
    assert np.abs(robokin.forward_kinematics(robot, q) - T).max() < 1e-9, text


CRAIG = r"""
\begin{table}
\begin{tabular}{|c|c|c|c|c|}
\hline
$i$ & $\alpha_{i-1}$ & $a_{i-1}$ & $d_i$ & $\theta_i$ \\ \hline
1 & $0$ & 0 & 0 & $\theta_1$ \\ \hline
2 & $-90^\circ$ & 0 & 0 & $\theta_2$ \\ \hline
3 & 0 & $a_2$ & $d_3$ & $\theta_3$ \\ \hline
4 & $-90^\circ$ & $a_3$ & $d_4$ & $\theta_4$ \\ \hline
5 & $90^\circ$ & 0 & 0 & $\theta_5$ \\ \hline
6 & $-90^\circ$ & 0 & 0 & $\theta_6$ \\ \hline
\end{tabular}
\caption{Link parameters of the PUMA 560}
\end{table}
"""
"""J. J. Craig, Introduction to Robotics, 3rd ed., figure 3.21."""

STANFORD = """
| Link | dᵢ | aᵢ | αᵢ | θᵢ |
|------|----|----|----|----|
| 1 | 0 | 0 | −90 | θ₁* |
| 2 | d₂ | 0 | +90 | θ₂* |
| 3 | d₃* | 0 | 0 | 0 |
| 4 | 0 | 0 | −90 | θ₄* |
| 5 | 0 | 0 | +90 | θ₅* |
| 6 | d₆ | 0 | 0 | θ₆* |

d2 = 0.154, d6 = 0.263
"""
"""M. W. Spong, S. Hutchinson and M. Vidyasagar, Robot Modeling and Control, table 3.4: * marks the variables."""

UR5 = """Kinematics,theta [rad],a [m],d [m],alpha [rad]
Joint 1,0,0,0.089159,π/2
Joint 2,0,-0.425,0,0
Joint 3,0,-0.39225,0,0
Joint 4,0,0,0.10915,π/2
Joint 5,0,0,0.09465,-π/2
Joint 6,0,0,0.0823,0
"""
"""Universal Robots, support article "DH parameters for calculations of kinematics and dynamics"."""

KHALIL = "j\tσ\tα\td\tθ\tr\n1\t0\t0\t0\tθ1\t0\n2\t0\tπ/2\t0\tθ2\t0\n3\t0\t0\tD3\tθ3\t0\n4\t0\t-π/2\t0\tθ4\tRL4\n" \
    "5\t0\tπ/2\t0\tθ5\t0\n6\t0\t-π/2\t0\tθ6\t0\n"  # fmt: skip
"""W. Khalil and E. Dombre, Modeling, Identification and Control of Robots, table 3.1: the Stäubli RX-90."""


VALUES = {"D3": "450", "RL4": "450"}


def read(text, **wishes):
    made = described_table(text, Wishes("arm", **wishes))
    return made, read_text(made.text)


def test_craigs_table_in_latex():
    values = {"a2": "431.8", "a3": "20.32", "d3": "150", "d4": "433.07"}
    made, robot = read(CRAIG, values=values)
    assert robot.convention == "modified" and made.types == "RRRRRR" and not made.missing
    assert np.degrees([row.alpha for row in robot.rows]) == pytest.approx([0, -90, 0, -90, 90, -90])
    assert [row.a for row in robot.rows] == pytest.approx([0, 0, 0.4318, 0.02032, 0, 0])
    assert described_table(CRAIG, Wishes()).missing == ("d3", "a2", "d4", "a3")


def test_spongs_stars_and_values_beside_the_table():
    made, robot = read(STANFORD)
    assert made.types == "RRPRRR" and robot.parameters == {"d2": 0.154, "d6": 0.263}
    same(robot, robokin.load("stanford"), 3)


def test_a_table_without_variables_wants_the_types():
    with pytest.raises(InputError, match=r"--types .* such as RRRRRR"):
        read(UR5)
    made, robot = read(UR5, types="RRRRRR")
    assert "alpha: pi/2" in made.text
    same(robot, robokin.load("ur5"), 4)


def test_khalils_letters():
    made, robot = read(KHALIL, values=VALUES)
    assert robot.convention == "modified" and any("Khalil" in note for note in made.notes)
    assert [row.a for row in robot.rows][2:4] == pytest.approx([0.45, 0]) and robot.rows[3].d == pytest.approx(0.45)
    bare = "\n".join(
        "\t".join(cell for k, cell in enumerate(line.split("\t")) if k != 1) for line in KHALIL.split("\n")
    )
    with pytest.raises(InputError, match="columns d and r"):
        read(bare)
    _, same_robot = read(bare, columns=("i", "alpha", "a", "theta", "d"), convention="modified", values=VALUES)
    same(robot, same_robot, 6)


def test_rows_may_be_columns():
    made, robot = read(",1,2,3\nθ,q1,q2,q3\nd,0,0,0\na,30,20,10\nα,0,0,0\n")
    same(robot, read_text(made.text), 5)
    assert [row.a for row in robot.rows] == pytest.approx([0.03, 0.02, 0.01])


@pytest.mark.parametrize(
    ("cell", "limits"),
    [("±170", (-170, 170)), ("-90 … 110", (-90, 110)), ("[−90, 110]", (-90, 110)), ("-90° to 110°", (-90, 110)),
     ("+110/-90", (-90, 110)), ("-90..110", (-90, 110)), ("−90~110", (-90, 110)), ("-90 110", (-90, 110)),
     ("-90 - 110", (-90, 110)), ("(-90°,110°)", (-90, 110)), ("0-200", (0, 200)), ("+/- 170", (-170, 170))],
)  # fmt: skip
def test_limits_as_tables_write_them(cell, limits):
    _, robot = read(f"i;θ;d;a;α;range\n1;q1;0;0;90°;{cell}\n")
    assert np.degrees(robot.limits[0]) == pytest.approx(limits)


def test_what_a_table_leaves_open_is_said():
    made, _ = read("i;θ;d;a;α;comment\n1;q1;0;300;90°;elbow\n")
    said = " ".join(made.notes)
    assert "convention: standard" in said and "'comment' is left out" in said and "taken for mm (up to 300)" in said
    assert all(f"# {note}" in made.text for note in made.notes)
    made, _ = read("i;θ;d;a;α\n1;q1;0;0.3;90\n2;90;0;0.1;0\n")
    assert "line 3 names no variable: its row is fixed" in made.notes and made.types == "RF"
    made, _ = read("i;type;θ;d;a;α\n1;R;90;0;0.3;-90\n")
    assert "theta: q1 + 90" in made.text and any("at zero" in note for note in made.notes)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("hello", "found no table"),
        ("", "found no table"),
        ("a b c\n1 2 3\n", "found no headings in line 1"),
        ("i,theta,d,a\n1,q1,0,0\n", "found no headings|found no column alpha"),
        ("i,theta,theta,d,a,alpha\n1,q1,q1,0,0,0\n", "two columns theta"),
        ("i,theta,d,a,alpha\n", "found no table"),
        ("i;theta;d;a;alpha\n1;q1;1,050;0;90\n", "found 1,050, expected a number with a point"),
        ("i,theta,d,a,alpha\n1,q1,0.5 mm,0.2 m,90\n", "found lengths in m and in mm"),
        ("i,theta,d,a,alpha\n1,q1,90°,0,90\n", "found deg in d, a length"),
        ("i,type,theta,d,a,alpha\n1,spherical,q1,0,0,90\n", "found the type 'spherical'"),
        ("i,theta,d,a,alpha,limits\n1,q1,0,0,90,wide\n", "found the limits 'wide'"),
        ("i,theta,d,a,alpha\n1,q1,0,0,2\n", "--angle deg or --angle rad"),
        ("i,theta,d,a,alpha\n1,q1,(3,0,90\n", "found no table|expected"),
        ("i,theta,d,a,alpha\n1,q1,import os,0,90\n", "expected"),
        ("<table><tr><td>i</td></tr></table>", "no table"),
        ("x" * 200_001, "characters"),
    ],
)
def test_what_is_no_table_is_told_so(text, sentence):
    with pytest.raises(InputError, match=sentence):
        made = described_table(text, Wishes())
        read_text(made.text)


@pytest.mark.parametrize("seed", range(300))
def test_a_damaged_table_ends_in_a_sentence_or_in_a_description(seed):
    rng = np.random.default_rng(seed)
    text = [CRAIG, STANFORD, UR5, KHALIL][seed % 4]
    letters = [*text]
    for _ in range(rng.integers(1, 12)):
        at = rng.integers(len(letters))
        kind = rng.integers(4)
        if kind == 0:
            del letters[at]
        elif kind == 1:
            letters.insert(at, str(rng.choice([*"|&\\\t,;*°πθ{}()[]#:'\"-−± \n0"])))
        else:
            other = rng.integers(len(letters))
            letters[at], letters[other] = letters[other], letters[at]
    try:
        made = described_table("".join(letters), Wishes("x: y # z"))
        if not made.missing:
            read_text(made.text)
    except InputError:
        pass


@pytest.mark.parametrize(("unit", "hand"), [("m", "0.1"), ("cm", "10"), ("mm", "100"), ("in", "4")])
def test_the_hand_that_waits_is_of_a_size_in_its_unit(unit, hand):
    made = described_table("theta d a alpha\nq1 0 1 0\n", Wishes(length=unit, angle="deg"))
    assert f"# tool: Trans(0, 0, {hand})  " in made.text
