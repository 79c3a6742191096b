"""What robots, mechanisms and wheeled bases are: frozen values with read-only arrays; no files, no printing."""

from robokin.model.mechanism import Mechanism, MechanismJoint, Rounding
from robokin.model.robot import Joint, JointType, Robot
from robokin.model.wheeled import Wheel, WheeledBase

__all__ = ["Joint", "JointType", "Mechanism", "MechanismJoint", "Robot", "Rounding", "Wheel", "WheeledBase"]
