"""First lines, an extension of the grader: the one cause that comes first in a run."""
