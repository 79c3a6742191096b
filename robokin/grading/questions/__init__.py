"""Questions with other numbers for each student, drawn from a seed, and what their answers are marked against."""
