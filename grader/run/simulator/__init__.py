"""What happens in the simulator's process of a run."""
