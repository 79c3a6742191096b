"""The arithmetic of motion: a robot's table as a chain, and frames along it."""
