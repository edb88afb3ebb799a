"""An exercise: exercise.yaml, checks, verdicts."""

#: The exercise that is meant where none is named.
DEFAULT = "turtlesim_challenge"
