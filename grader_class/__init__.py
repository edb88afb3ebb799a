"""A class, an extension of the grader: find its hand-ins, grade them, hand out what follows."""
