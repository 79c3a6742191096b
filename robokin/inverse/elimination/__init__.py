"""All solutions of a general chain of six joints: elimination, Newton's steps, homotopies, counting."""
