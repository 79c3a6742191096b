"""Named expressions of a description, which may refer to each other in any order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from robokin.errors import ExpressionError
from robokin.formats.expression_tokens import tokenize
from robokin.formats.number_expressions import Scope, Value, evaluate


@dataclass
class Parameters:
    """Named expressions that may refer to each other in any order; evaluated when asked for.

    `texts` maps a name to its expression, `known` to its value, `broken` to what is wrong with it or with what it
    needs.
    """

    texts: Mapping[str, str]
    degrees: bool
    known: dict[str, Value] = field(default_factory=dict)
    broken: dict[str, ExpressionError] = field(default_factory=dict)

    def scope(self) -> Scope:
        """A scope in which these parameters can be named."""
        return Scope(self.degrees, self.texts.keys(), self.value)

    def value(self, name: str) -> Value:
        """The value of one parameter. Raises ExpressionError, also for a circle.

        What it refers to is evaluated first, so that a long chain of parameters needs no deep recursion
        and an error is that of the parameter where it stands (the error's `parameter`).
        """
        if name in self.known:
            return self.known[name]
        if name in self.broken:
            raise self.broken[name]
        path: dict[str, Iterator[str]] = {}
        try:
            return self._evaluated(name, path)
        except ExpressionError as error:
            # Whoever needs one of these meets the same mistake again.
            self.broken.update(dict.fromkeys(path, error))
            raise

    def _evaluated(self, name: str, path: dict[str, Iterator[str]]) -> Value:
        """The value; `path` holds the parameters that wait for one another."""
        scope = self.scope()
        path[name] = iter(())
        path[name] = self._named(name)
        while path:
            last = next(reversed(path))
            needed = next((other for other in path[last] if other not in self.known), None)
            if needed is None:
                try:
                    self.known[last] = evaluate(self.texts[last], scope)
                except ExpressionError as error:
                    error.parameter = error.parameter or last
                    raise
                del path[last]
            elif needed in self.broken:
                raise self.broken[needed]
            elif needed in path:
                raise _circle([*path][[*path].index(needed) :])
            else:
                path[needed] = iter(())
                path[needed] = self._named(needed)
        return self.known[name]

    def _named(self, name: str) -> Iterator[str]:
        """The parameters that one refers to."""
        try:
            tokens = tokenize(self.texts[name])
        except ExpressionError as error:
            error.parameter = name
            raise
        return (token.text for token in tokens if token.kind == "name" and token.text in self.texts)


def _circle(names: list[str]) -> ExpressionError:
    """The error for parameters that refer to each other, the last to the first."""
    few = names if len(names) <= 10 else [*names[:9], "…", names[-1]]
    return ExpressionError(
        f"found parameters that refer to each other in a circle ({' -> '.join([*few, names[0]])}), "
        "expected a number in one of them",
        parameter=names[0],
    )
