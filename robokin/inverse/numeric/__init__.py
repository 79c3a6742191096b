"""Solutions and nearest configurations found step by step from initial guesses."""
