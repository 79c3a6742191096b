"""Solutions from the geometry of an arm's axes: the equations in one joint that it comes down to."""
