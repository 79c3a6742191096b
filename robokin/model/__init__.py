"""What a robot and a mechanism are: frozen, validated values with read-only arrays; no files, no printing."""

from robokin.model.mechanism import Mechanism, MechanismJoint
from robokin.model.robot import Joint, JointType, Robot

__all__ = ["Joint", "JointType", "Mechanism", "MechanismJoint", "Robot"]
