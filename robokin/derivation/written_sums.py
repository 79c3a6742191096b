"""Sums as text and as LaTeX."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

from robokin.derivation.angle_sums import Function
from robokin.derivation.symbol_sums import Product, Sum, Symbol

GREEK = frozenset(
    {"alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu", "xi",
     "pi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega"}
)  # fmt: skip
"""Names that LaTeX has a letter for."""


def written(a: Sum, show: Callable[[float], str] = repr) -> str:
    """A sum as text that Python reads too; `show` writes its numbers."""
    return _sum(a, "*", lambda factor: factor.name, show)


def latex(a: Sum, functions: Mapping[str, Function], show: Callable[[float], str] = repr) -> str:
    """A sum in LaTeX's mathematics: `c_{1} (a_{2} c_{2} + a_{3} c_{23})`."""

    def name(factor: Symbol) -> str:
        function = functions.get(factor.name)
        return latex_name(factor.name) if function is None else latex_function(function)

    return _sum(a, " ", name, show)


def latex_function(function: Function) -> str:
    """A cosine or sine by its joints: `c_{23}`, `s_{12-4}`, `c_{\\alpha_{2}}`."""
    apart = "," if any(len(label) > 1 for label, _ in function.labels) else ""
    index = apart.join(("-" if sign < 0 else "") + _latex_label(label) for label, sign in function.labels)
    return f"{function.name[0]}_{{{index}}}"


def latex_name(name: str) -> str:
    """A parameter's or a length's name: `a_{2}`, `\\theta_{3}`, `\\mathrm{upper\\_arm}`."""
    match = re.fullmatch(r"([^\W\d_]+)_?(\d*)(_*)", name)
    if match is None or not (len(match[1]) == 1 or match[1] in GREEK):
        return rf"\mathrm{{{name.replace('_', chr(92) + '_')}}}"
    letter = match[1] if len(match[1]) == 1 else f"\\{match[1]}"
    return letter + (f"_{{{match[2]}}}" if match[2] else "") + "'" * len(match[3])


def _latex_label(label: str) -> str:
    return rf"\alpha_{{{label[1:]}}}" if label.startswith("a") else label


def _sum(a: Sum, dot: str, name: Callable[[Symbol], str], show: Callable[[float], str]) -> str:
    if not a:
        return "0"
    text = ""
    for term in a.terms:
        sign = "-" if term.coefficient < 0 else "+"
        text += f" {sign} " if text else sign.strip("+")
        text += _product(term, dot, name, show)
    return text


def _product(term: Product, dot: str, name: Callable[[Symbol], str], show: Callable[[float], str]) -> str:
    size = abs(term.coefficient)
    parts = [show(size)] if size != 1 or not term.factors else []
    parts += [
        f"({_sum(factor, dot, name, show)})" if isinstance(factor, Sum) else name(factor) for factor in term.factors
    ]
    return dot.join(parts)
