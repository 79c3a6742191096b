"""A tree of links as the text of a description, which loads again as the same tree."""

from __future__ import annotations

from robokin.errors import InputError
from robokin.formats.description_lines import (
    coupling_lines,
    head_lines,
    pose_lines,
    row_lines,
    transform_lines,
    yaml_text,
)
from robokin.formats.exact_numbers import transform_text
from robokin.formats.schema import MAX_ROWS, VERSION
from robokin.formats.tree_branches import BranchTip, TreeBranch, TreeBranches
from robokin.model import JointType
from robokin.units import Units


def written_tree(parts: TreeBranches) -> str:
    """The description of a tree in its own units, as YAML.

    Numbers are the shortest that read as the same value; parameters are resolved, notes left out. Joints are called
    `branch.joint`, and q runs through the branches in turn (`parts.order`). Of a joint with one limit the other is
    written as 1e6 m or rad. Raises InputError for more rows than a description holds.
    """
    tree, units = parts.tree, parts.tree.units
    count = sum(len(branch.rows) for branch in parts.branches)
    if count > MAX_ROWS:
        raise InputError(f"{tree.name} has {count} rows in all branches, expected at most {MAX_ROWS} in a description")
    lines = [f"robokin: {VERSION}", *head_lines(tree.name or tree.id or "robot", tree.description, tree.source, units)]
    conventions = [branch.chain.convention for branch in parts.branches]
    common = max(conventions, key=conventions.count)
    lines.append(f"convention: {common}")
    lines += transform_lines("base", tree.graph.base, units)
    lines.append("branches:")
    for branch in parts.branches:
        lines += [f"  {yaml_text(branch.name)}:", *(f"    {line}" for line in _branch_lines(branch, common, units))]
    turning = {
        name: row.type is JointType.REVOLUTE
        for branch in parts.branches
        for name, row in zip(branch.names, branch.rows, strict=True)
    }
    lines += coupling_lines(parts.couplings, turning, units)
    if parts.tips and not parts.default_tips:
        lines += ["tips:", *(f"  - {_tip(tip, units)}" for tip in parts.tips)]
    order = [*parts.order]
    poses = {name: q[order] for name, q in tree.poses.items()}
    lines += pose_lines(poses, tree.revolute[order], units)
    return "\n".join(lines) + "\n"


def _branch_lines(branch: TreeBranch, common: str, units: Units) -> list[str]:
    """The lines of a branch; the convention is said where it is not that of the file."""
    chain = branch.chain
    lines = [f"on: {yaml_text(branch.on)}"] if branch.on else []
    lines += [f"convention: {chain.convention}"] if chain.convention != common else []
    lines += transform_lines("base", chain.base, units)
    lines += ["joints:", *(f"  {line}" for line in row_lines(branch.rows, chain.convention, units))]
    return lines + transform_lines("tool", chain.tool, units)


def _tip(tip: BranchTip, units: Units) -> str:
    """A tip as the name of its branch, or as a mapping in one line."""
    tool = transform_text(tip.tool, units)
    if tip.name == tip.on and not tool:
        return yaml_text(tip.name)
    cells = {"name": yaml_text(tip.name), "on": yaml_text(tip.on)} | ({"tool": f'"{tool}"'} if tool else {})
    return f"{{{', '.join(f'{cell}: {text}' for cell, text in cells.items())}}}"
