"""Forward kinematics, link frames, Jacobian; the one home of the Denavit-Hartenberg matrices."""
