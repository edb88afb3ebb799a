"""Find the names of students in all that is kept of a class, and put something else there."""
