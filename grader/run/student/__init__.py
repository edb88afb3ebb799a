"""What happens in the submission's process of a run."""
