"""The closed form of a redundant arm's window as the native kernel knows it."""

from __future__ import annotations

from robokin.inverse.analysis import Analysis
from robokin.inverse.closed_form.form_tape import form_tape
from robokin.inverse.closed_form.straight_forms import straight_source
from robokin.inverse.one_target_arm import kernel_of
from robokin.kernel.facts import fact


@fact
def window_form(analysis: Analysis) -> object | None:
    """What the native kernel knows the closed form of the window by, without limits; None where blocks solve it."""
    six = analysis.six
    if six is None or analysis.loop is None or six.virtual or not six.chain.revolute.all() or not analysis.redundancy:
        return None
    source = straight_source(analysis.solver)
    return None if source is None else kernel_of(analysis, form_tape(source), (), ())
