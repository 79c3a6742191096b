"""The signs that name an arm's postures as a tape for the native kernel.

Statement. Give the signs of configurations in a microsecond, where arrays take a hundred for a handful.
Derivation. The quantities of `postures` are asked once about axes whose numbers are terms of code (`straight_line`):
what they note is read as a closed form's code is (`form_tape`). So the formulas have one home.
Degenerate case. None where there is no native kernel, for fewer than six joints, and for a quantity that is no sum of
products (a determinant).
"""

from __future__ import annotations

from robokin.inverse.closed_form.form_tape import form_tape
from robokin.inverse.postures import Postures
from robokin.kernel.code_lines import Term, written
from robokin.kernel.facts import fact
from robokin.kernel.joint_axes import Axes
from robokin.kernel.native_kernel import handle, native


@fact
def posture_code(postures: Postures) -> object | None:
    """What the native kernel knows an arm's signs by, or None."""
    chain = handle(postures.chain)
    if native is None or chain is None or postures.chain.n != 6 or not 0 < len(postures.signs) <= 6:
        return None
    lines: list[tuple[str, str]] = []
    inputs = [Term.named(lines, f"i{k}") for k in range(39)]
    z, o = ([inputs[first + 3 * i : first + 3 * i + 3] for i in range(6)] for first in (0, 18))
    axes = Axes.of_terms(postures.chain, z, o, inputs[36:])
    try:
        values = [sign.quantity(axes)[0] for sign in postures.signs]
    except TypeError:
        return None  # numpy does not work a determinant out for terms
    source = ["def signs(rows):", f"    {', '.join(one.name for one in inputs)} = rows"]
    source += [f"    {name} = {line}" for name, line in lines]
    source += [f"    leaves.append(({''.join(f'{written(value)}, ' for value in values)}))"]
    tape = form_tape("\n".join(source))
    if tape is None or tape.slots > native.most_slots:
        return None
    known: object = native.signs(chain, postures.size, tape.steps, tape.constants, tape.leaves[0])
    return known
