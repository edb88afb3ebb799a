"""What the source of a submission shows: no error by itself, and seldom what was meant."""
