"""The exercises, a folder each: exercise.yaml and checks.py."""
