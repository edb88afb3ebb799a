"""What an exercise is: exercise.yaml, checks, verdicts."""
