"""Sets of configurations that reach one pose: classified, followed, cut at the joint limits."""
