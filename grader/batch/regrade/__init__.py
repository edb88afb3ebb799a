"""What a changed rubric changes in a class that is graded: told first, written when asked for."""
