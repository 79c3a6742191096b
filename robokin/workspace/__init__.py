"""What a robot can reach: sampling, size with error bounds, dexterity."""
