"""The second exercise: draw a square of side 2 metres and return to the start."""
