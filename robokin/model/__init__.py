"""What robots, mechanisms and wheeled bases are: frozen values with read-only arrays; no files, no printing."""

from robokin.model.coupled_robot import CoupledRobot, expect_uncoupled
from robokin.model.mechanism import Mechanism, MechanismJoint, Rounding, expect_mechanism
from robokin.model.robot import Joint, JointType, Robot, expect_robot
from robokin.model.tree import Tree, expect_tree
from robokin.model.wheeled_base import Wheel, WheeledBase, expect_wheeled

__all__ = [
    "CoupledRobot", "Joint", "JointType", "Mechanism", "MechanismJoint", "Robot", "Rounding", "Tree", "Wheel",
    "WheeledBase", "expect_mechanism", "expect_robot", "expect_tree", "expect_uncoupled",
    "expect_wheeled",
]  # fmt: skip
