"""Forward kinematics in symbols: the matrices of a robot as a lecture writes them by hand."""
