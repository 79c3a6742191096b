"""A cell of a pasted table as an expression of a description: Greek letters, degree signs, subscripts, LaTeX."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass

from robokin.formats.expression_functions import FUNCTIONS, Function
from robokin.formats.expression_tokens import Token
from robokin.formats.number_expressions import Parser, Scope, Value

DEGREE_SIGNS = "°º˚⁰∘"
DASHES = "−–—‒‐‑﹣－"
GREEK = {
    "α": "alpha", "⍺": "alpha", "β": "beta", "γ": "gamma", "δ": "delta", "θ": "theta", "ϑ": "theta", "φ": "phi",
    "ϕ": "phi", "ψ": "psi", "ω": "omega", "λ": "lambda", "σ": "sigma", "π": "pi", "ε": "epsilon", "ρ": "rho", "ℓ": "l",
}  # fmt: skip
LATEX = (
    (r"\\(?:SI|qty)\s*\{([^{}]*)\}\s*\{([^{}]*)\}", r"\1 \2"),
    (r"\\milli\s*\\met(?:re|er)\b", "mm"),
    (r"\\met(?:re|er)\b", "m"),
    (r"\\radian\b", "rad"),
    (r"\\(?:text|mathrm|mathbf|mathit|mathsf|textbf|textit|boldsymbol|bm|operatorname|mbox)\s*\{([^{}]*)\}", r"\1"),
    (r"\\[dt]?frac\s*\{([^{}]*)\}\s*\{([^{}]*)\}", r"(\1)/(\2)"),
    (r"\\[dt]?frac\s*\{?(\\pi|\d)\}?\s*\{?(\d+)\}?", r"(\1)/(\2)"),
    (r"\\sqrt\s*\{([^{}]*)\}", r"sqrt(\1)"),
    (r"\\(?:a|arc)(sin|cos|tan)\s*\{([^{}]*)\}", r"a\1(\2)"),
    (r"\\(sin|cos|tan|arcsin|arccos|arctan)(?=\s*\()", r"\1"),
    (r"\^?\s*\{?\s*\\(?:circ|degree)\b\s*\}?|\\(?:textdegree|degree|ang)\b", "°"),
    (r"\^\s*\{?\s*(?:\\?\*|\\ast|\\star)\s*\}?|\\ast\b|\\star\b", "*"),
    (r"\\(?:cdot|times)\b", "*"),
    (r"\\pm\b", "±"),
    (r"\\(?:left|right|displaystyle|quad|qquad|,|;|!|:| )", " "),
    (r"\\(?:var)?(theta|alpha|phi|psi|beta|gamma|sigma|pi)(?![A-Za-z])", r"\1"),
    (r"\\ell(?![A-Za-z])", "l"),
    (r"\\infty\b", "∞"),
    (r"\\(?:dots|ldots|cdots)\b", "…"),
    (r"\\to\b", " to "),
    (r"\\\(|\\\)|\$", ""),
    (r"\\([%&#_])", r"\1"),
)
UNITS = {
    "mm": "mm", "millimetres": "mm", "millimeters": "mm", "cm": "cm", "centimetres": "cm", "centimeters": "cm",
    "m": "m", "metres": "m", "meters": "m", "in": "in", "inch": "in", "inches": "in",
    "°": "deg", "deg": "deg", "degs": "deg", "degree": "deg", "degrees": "deg", "rad": "rad", "rads": "rad",
    "radian": "rad", "radians": "rad",
}  # fmt: skip
"""Units as tables write them, and their names here."""

UNIT = re.compile(r"(?<=[\d.)])\s*(millimet(?:er|re)s|mm|cm|m|inch(?:es)?|in|degrees?|deg|radians?|rads?)\b")
FRACTIONS = "¼½¾⅐⅑⅒⅓⅔⅕⅖⅗⅘⅙⅚⅛⅜⅝⅞"
FRACTION = re.compile(
    rf"(?:(?<![\w.,])(?P<whole>\d+) ?|(?P<glued>(?<=\w)))?(?P<part>[{FRACTIONS}])"
    r"(?P<factor>\s?(?=[A-Za-zπ√(\\])(?!(?:mm|cm|m|in|inch(?:es)?|deg|degrees?|rad|radians?)\b))?"
)
"""A fraction that is one letter, and the whole number before it: 2½ is two and a half, where its digits are 21/2."""

SUPERSCRIPTS = str.maketrans("¹²³⁴⁵⁶⁷⁸⁹", "123456789")
EMPHASIS = (
    re.compile(r"(?<![\w)*])\*\*(?=[^\s*])([^*\n]{1,200})(?<=\S)\*\*(?![\w(*])"),
    re.compile(r"(?<!\w)__(?=\S)([^_\n]{1,200})(?<=\S)__(?!\w)"),
)
"""What Markdown prints bold; a power, as in `L3**2 + L2**2`, has a letter or a digit before its stars."""

OF_CODE = (
    (re.compile(r"\bM_PI_([24])\b"), r"(pi/\1)"),
    (re.compile(r"(?<!\w)(?:[A-Za-z]\w{0,20}\.|M_)?(?:pi|PI|Pi)\b"), "pi"),
    (re.compile(r"(?<!\w)self\.(?=[A-Za-z])"), ""),
    (re.compile(r"(?<!\w)arc(sin|cos|tan)(2?)(?=\s*\()"), r"a\1\2"),
    (re.compile(r"(?<![\w.])[A-Za-z]\w{0,20}\.(?=(?:sqrt|a?(?:sin|cos|tan)|atan2|abs)\()"), ""),
    (re.compile(r"(?<!\w)(q|th|theta|t)\s?\((\d{1,3})\)", re.IGNORECASE), r"\1\2"),
    (re.compile(r"(?<!\w)(?:jA|joints?|angles?|joint_angles?)\s?\((\d{1,3})\)"), r"q\1"),
)
"""How programs write what a description names otherwise."""

NOTHING = ("", "-", "none", "n/a", "na", "nil", "~", "x", "…", "...")
VARIABLE = re.compile(r"\(?\s*(?:joint\s+)?(?:var(?:iable|\.)?|varies)\s*\)?$", re.IGNORECASE)


@dataclass(frozen=True)
class PastedCell:
    """What a cell says: an expression ("" for nothing), the units it names, whether a star marks it as a variable.

    text: as a description's cell takes it, but for its names; variable: whether the cell says "variable" or has a star.
    """

    text: str
    units: tuple[str, ...] = ()
    variable: bool = False


class NamesUnknown(Parser):
    """Reads an expression of which no name has a value yet."""

    def call(self, function: Function, arguments: tuple[float, ...], name: str, token: Token) -> float:
        """Any number: where a function has none is seen when the names have values."""
        return 0.5


def read_expression(text: str) -> None:
    """Read an expression whose names may have any value. Raises ExpressionError where it is none."""
    names = {word for word in re.findall(r"[A-Za-z]\w*", text) if word not in FUNCTIONS}
    scope = Scope(names=names, lookup=lambda name: Value(0.5 + 1.0 / (1.0 + sum(map(ord, name)))))
    parser = NamesUnknown(text, scope)
    parser.number()
    parser.end()


def plain_text(text: str) -> str:
    """A text without LaTeX, typography and Greek letters, its subscripts behind the letters: θ₁ is theta1."""
    for sign in DEGREE_SIGNS:
        text = text.replace(sign, "°")
    text = text.replace("`", "")
    for bold in EMPHASIS:
        text = bold.sub(r"\1", text)
    # A power or the mark of a footnote is no digit of the number before it.
    text = re.sub(r"[¹²³⁴⁵⁶⁷⁸⁹]+", lambda raised: "^" + raised[0].translate(SUPERSCRIPTS), text)
    text = FRACTION.sub(_fraction, text)
    for _ in range(3):  # what stands in braces may have braces
        for pattern, plain in LATEX:
            text = re.sub(pattern, plain, text)
    text = "".join(letter if letter in "°…" else unicodedata.normalize("NFKC", letter) for letter in text)
    for dash in DASHES:
        text = text.replace(dash, "-")
    text = text.replace("∗", "*")
    for letter, name in GREEK.items():
        text = text.replace(letter, name).replace(letter.upper(), name) if letter != "ℓ" else text.replace(letter, name)
    text = re.sub(r"\^\s*\{?o\}?(?!\w)", "°", text)
    text = re.sub(r"_\s*\{?\s*([\w.\-+ ]*?)\s*\}?(?=$|[^\w{}.\-+ ]|\s)", r"_\1", text)
    return " ".join(
        text.replace("{", "").replace("}", "").replace("⁄", "/").replace("×", "*").replace("·", "*").split()
    )


def _fraction(found: re.Match[str]) -> str:
    """A fraction as a factor; behind a name it is none, and no expression."""
    before = f"{found['whole']}+" if found["whole"] else ""
    glued, factor = " " * (found["glued"] is not None), "*" * (found["factor"] is not None)
    return f"{glued}({before}{found['part']}){factor}"


def pasted_cell(text: str, *, decimal_commas: bool = False) -> PastedCell:
    """What a cell says."""
    text = plain_text(text)
    if emphasised := re.fullmatch(r"\*([^*]+)\*", text):
        text = emphasised[1].strip()
    if text.lower() in NOTHING:
        return PastedCell("")
    if VARIABLE.fullmatch(text):
        return PastedCell("", (), True)
    text = re.sub(r"\b(theta|q|d)\s?\*\s?_?(\d{1,2})\b(?!\s*[\w.(])", r"\1\2*", text)  # θ∗1 as a PDF is copied
    remarked = False
    if match := re.search(r"\s*\*{0,2}\(\s*var(?:iable|\.)?\s*\)\*{0,2}", text, re.IGNORECASE):
        remarked, text = True, text[: match.start()] + text[match.end() :]
    starred = remarked or bool(re.search(r"[A-Za-z]\w*\s*\*+(?=\s*(?:$|[-+)]))|^\s*\*+\s*\w", text))
    text = re.sub(r"([A-Za-z]\w*)\s*\*+(?=\s*(?:$|[-+)]))", r"\1", text)
    text = re.sub(r"^\s*\*+\s*", "", text)
    if decimal_commas:
        text = re.sub(r"(?<=\d),(?=\d)", ".", text)
    for written, meant in OF_CODE:
        text = written.sub(meant, text)
    text = re.sub(r"^[A-Za-z]\w*\s*=\s*", "", text)  # d1 = 0.5
    units = ["deg"] * ("°" in text) + [UNITS[match[1]] for match in UNIT.finditer(text) if match[1] in UNITS]
    text = UNIT.sub("", text.replace("°", ""))
    text = re.sub(r"\(\s*t\s*\)", "", text)  # q(t), the variable
    text = re.sub(r"√\s*\(", "sqrt(", text)
    text = re.sub(r"√\s*(\w+)", r"sqrt(\1)", text).replace("÷", "/").replace("^", "**")
    text = re.sub(r"(?<=[A-Za-z])_(?=\d)", "", text)
    text = re.sub(r"(?<![a-z])\((\w+)\)(?=\s*/)", r"\1", text)
    text = re.sub(r"/\s*\((\w+)\)", r"/\1", text)
    text = re.sub(r"(?<![\w.])(\d+\.?\d*|\.\d+)\s*(?=[A-DF-Za-df-z(]|[eE](?![-+]?\d))", r"\1*", text)
    text = re.sub(r"^\s*\+\s*", "", text)
    text = (
        re.sub(r"(?<!\d[eE])(?<!\d\.[eE])(?<![\s*/(])\s*([+\-])\s*(?=[\w(.])", r" \1 ", text).strip()
        if re.search(r"[\w)]\s*[+\-]", text)
        else text
    )
    text = re.sub(r"^([+\-]) (?=\S)", r"\1", text)
    if whole := re.fullmatch(r"\(([^()]+)\)", text):
        text = whole[1].strip()
    return PastedCell(text.strip(), tuple(dict.fromkeys(units)), starred)
