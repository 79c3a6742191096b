"""Robot kinematics from a YAML file.

    import robokin
    robot = robokin.load("puma560")
    T = robokin.forward_kinematics(robot, q)     # q: (..., n) -> (..., 4, 4)

SI units and radians, arrays in and out, any leading batch shape.
"""

from __future__ import annotations

TYPE_CHECKING = False  # `typing` has the same, and takes a while to load
if TYPE_CHECKING:
    from robokin import dataframes as dataframes
    from robokin import documents as documents
    from robokin import notebook as notebook
    from robokin.drawings import draw as draw
    from robokin.errors import DescriptionError as DescriptionError
    from robokin.errors import InputError as InputError
    from robokin.errors import InputTypeError as InputTypeError
    from robokin.errors import RobokinError as RobokinError
    from robokin.formats import load as load
    from robokin.formats import load_mechanism as load_mechanism
    from robokin.formats import load_tree as load_tree
    from robokin.formats import load_wheeled as load_wheeled
    from robokin.formats.library import library_names as library_names
    from robokin.formats.pose_expressions import pose as pose
    from robokin.formats.pose_expressions import transform as transform
    from robokin.formats.robot_of_table import from_table as from_table
    from robokin.grading.marks import check_configuration as check_configuration
    from robokin.grading.marks import check_pose as check_pose
    from robokin.grading.marks import check_solutions as check_solutions
    from robokin.grading.marks import check_table as check_table
    from robokin.grading.tolerance import Tolerance as Tolerance
    from robokin.grading.tolerance import default_tolerance as default_tolerance
    from robokin.inverse.joint_paths import interpolate_joints as interpolate_joints
    from robokin.inverse.paths_to_poses import follow_line as follow_line
    from robokin.inverse.solve import solve_ik as solve_ik
    from robokin.inverse.swivel_angles import swivel_angle as swivel_angle
    from robokin.inverse.swivel_angles import swivel_solutions as swivel_solutions
    from robokin.inverse.tip_targets import solve_tips as solve_tips
    from robokin.inverse.trajectories import trajectory as trajectory
    from robokin.kernel.native_kernel import kernel_in_use as kernel_in_use
    from robokin.kinematics.dh_table import to_convention as to_convention
    from robokin.kinematics.forward import forward_kinematics as forward_kinematics
    from robokin.kinematics.forward import link_frames as link_frames
    from robokin.kinematics.jacobian import jacobian as jacobian
    from robokin.kinematics.singular import singular_configurations as singular_configurations
    from robokin.kinematics.tips import tip_poses as tip_poses
    from robokin.kinematics.velocity import differential_kinematics as differential_kinematics
    from robokin.mobility.manoeuvrability import manoeuvrability_of as manoeuvrability_of
    from robokin.mobility.verdict import mobility_of as mobility_of
    from robokin.model import Mechanism as Mechanism
    from robokin.model import Robot as Robot
    from robokin.model import Tree as Tree
    from robokin.model import WheeledBase as WheeledBase
    from robokin.question_sheets import mark_sheet as mark_sheet
    from robokin.question_sheets import question_sheet as question_sheet
    from robokin.question_sheets import statistics_of as statistics_of
    from robokin.spatial.conversions import axis_angle_from_rotation as axis_angle_from_rotation
    from robokin.spatial.conversions import euler_from_rotation as euler_from_rotation
    from robokin.spatial.conversions import quaternion_from_rotation as quaternion_from_rotation
    from robokin.spatial.conversions import rotation_from_axis_angle as rotation_from_axis_angle
    from robokin.spatial.conversions import rotation_from_euler as rotation_from_euler
    from robokin.spatial.conversions import rotation_from_quaternion as rotation_from_quaternion
    from robokin.spatial.conversions import rotation_from_rotvec as rotation_from_rotvec
    from robokin.spatial.conversions import rotation_from_rpy as rotation_from_rpy
    from robokin.spatial.conversions import rotvec_from_rotation as rotvec_from_rotation
    from robokin.spatial.conversions import rpy_from_rotation as rpy_from_rotation
    from robokin.spatial.rigid_poses import invert_pose as invert_pose
    from robokin.spatial.rigid_poses import pose_parts as pose_parts
    from robokin.symbol_matrices import symbols as symbols
    from robokin.units import Units as Units
    from robokin.workspace.analyse import analyse_workspace as analyse_workspace

__version__ = "0.1.0"

_MODULES = ("dataframes", "documents", "notebook")
"""Public modules, which are imported when they are first used, too."""

# Names are imported when they are first used, so that the command line starts without numpy.
_HOMES = {
    "Units": "robokin.units",
    "load": "robokin.formats",
    "from_table": "robokin.formats.robot_of_table",
    "load_mechanism": "robokin.formats",
    "load_tree": "robokin.formats",
    "load_wheeled": "robokin.formats",
    "RobokinError": "robokin.errors",
    "InputError": "robokin.errors",
    "DescriptionError": "robokin.errors",
    "forward_kinematics": "robokin.kinematics.forward",
    "link_frames": "robokin.kinematics.forward",
    "to_convention": "robokin.kinematics.dh_table",
    "kernel_in_use": "robokin.kernel.native_kernel",
    "solve_ik": "robokin.inverse.solve",
    "solve_tips": "robokin.inverse.tip_targets",
    "swivel_angle": "robokin.inverse.swivel_angles",
    "swivel_solutions": "robokin.inverse.swivel_angles",
    "jacobian": "robokin.kinematics.jacobian",
    "tip_poses": "robokin.kinematics.tips",
    "differential_kinematics": "robokin.kinematics.velocity",
    "singular_configurations": "robokin.kinematics.singular",
    "follow_line": "robokin.inverse.paths_to_poses",
    "interpolate_joints": "robokin.inverse.joint_paths",
    "trajectory": "robokin.inverse.trajectories",
    "mobility_of": "robokin.mobility.verdict",
    "manoeuvrability_of": "robokin.mobility.manoeuvrability",
    "Mechanism": "robokin.model",
    "Robot": "robokin.model",
    "Tree": "robokin.model",
    "analyse_workspace": "robokin.workspace.analyse",
    "WheeledBase": "robokin.model",
    "draw": "robokin.drawings",
    "symbols": "robokin.symbol_matrices",
    "transform": "robokin.formats.pose_expressions",
    "pose": "robokin.formats.pose_expressions",
    "pose_parts": "robokin.spatial.rigid_poses",
    "invert_pose": "robokin.spatial.rigid_poses",
    "Tolerance": "robokin.grading.tolerance",
    "default_tolerance": "robokin.grading.tolerance",
    "check_pose": "robokin.grading.marks",
    "check_configuration": "robokin.grading.marks",
    "check_solutions": "robokin.grading.marks",
    "check_table": "robokin.grading.marks",
    "question_sheet": "robokin.question_sheets",
    "mark_sheet": "robokin.question_sheets",
    "statistics_of": "robokin.question_sheets",
    "InputTypeError": "robokin.errors",
    "library_names": "robokin.formats.library",
    "rotation_from_rpy": "robokin.spatial.conversions",
    "rpy_from_rotation": "robokin.spatial.conversions",
    "rotation_from_euler": "robokin.spatial.conversions",
    "euler_from_rotation": "robokin.spatial.conversions",
    "rotation_from_quaternion": "robokin.spatial.conversions",
    "quaternion_from_rotation": "robokin.spatial.conversions",
    "rotation_from_axis_angle": "robokin.spatial.conversions",
    "axis_angle_from_rotation": "robokin.spatial.conversions",
    "rotation_from_rotvec": "robokin.spatial.conversions",
    "rotvec_from_rotation": "robokin.spatial.conversions",
}

__all__ = ["__version__", *_HOMES, *_MODULES]


def __getattr__(name: str) -> object:
    """Import a public name on first use."""
    from importlib import import_module

    if name in _MODULES:
        value: object = import_module(f"robokin.{name}")
    elif name in _HOMES:
        try:
            value = getattr(import_module(_HOMES[name]), name)
        except Exception as error:
            if type(error).__module__ != "robokin.errors":
                raise
            # Its sentence is about the environment, and the way to it of no interest.
            raise error.with_traceback(None) from None
    else:
        raise AttributeError(f"module 'robokin' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """The public names."""
    return sorted(__all__)
