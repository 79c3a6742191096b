"""Robot kinematics from a YAML file.

    import robokin
    robot = robokin.load("puma560")
    T = robokin.forward_kinematics(robot, q)     # q: (..., n) -> (..., 4, 4)

SI units and radians, arrays in and out, any leading batch shape.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from robokin.description import load as load
    from robokin.description import load_mechanism as load_mechanism
    from robokin.description import load_wheeled as load_wheeled
    from robokin.errors import DescriptionError as DescriptionError
    from robokin.errors import InputError as InputError
    from robokin.errors import RobokinError as RobokinError
    from robokin.inverse.path import follow_line as follow_line
    from robokin.inverse.path import interpolate_joints as interpolate_joints
    from robokin.inverse.solve import solve_ik as solve_ik
    from robokin.kinematics.forward import forward_kinematics as forward_kinematics
    from robokin.kinematics.forward import link_frames as link_frames
    from robokin.kinematics.jacobian import jacobian as jacobian
    from robokin.kinematics.singular import singular_configurations as singular_configurations
    from robokin.kinematics.velocity import differential_kinematics as differential_kinematics
    from robokin.mobility.verdict import mobility_of as mobility_of
    from robokin.mobility.wheeled import manoeuvrability_of as manoeuvrability_of
    from robokin.model import Mechanism as Mechanism
    from robokin.model import Robot as Robot
    from robokin.model import WheeledBase as WheeledBase
    from robokin.workspace.analyse import analyse_workspace as analyse_workspace

__version__ = "0.1.0"

# Names are imported when they are first used, so that the command line starts without numpy.
_HOMES = {
    "load": "robokin.description",
    "load_mechanism": "robokin.description",
    "load_wheeled": "robokin.description",
    "RobokinError": "robokin.errors",
    "InputError": "robokin.errors",
    "DescriptionError": "robokin.errors",
    "forward_kinematics": "robokin.kinematics.forward",
    "link_frames": "robokin.kinematics.forward",
    "solve_ik": "robokin.inverse.solve",
    "jacobian": "robokin.kinematics.jacobian",
    "differential_kinematics": "robokin.kinematics.velocity",
    "singular_configurations": "robokin.kinematics.singular",
    "follow_line": "robokin.inverse.path",
    "interpolate_joints": "robokin.inverse.path",
    "mobility_of": "robokin.mobility.verdict",
    "manoeuvrability_of": "robokin.mobility.wheeled",
    "Mechanism": "robokin.model",
    "Robot": "robokin.model",
    "analyse_workspace": "robokin.workspace.analyse",
    "WheeledBase": "robokin.model",
}

__all__ = ["__version__", *_HOMES]


def __getattr__(name: str) -> object:
    """Import a public name on first use."""
    if name not in _HOMES:
        raise AttributeError(f"module 'robokin' has no attribute {name!r}")
    from importlib import import_module

    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """The public names."""
    return sorted(__all__)
