"""Processes of a run: started, watched, kept apart, and ended so that none is left."""
