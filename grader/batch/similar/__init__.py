"""Look at these together: hand-ins that behave alike, or are written alike, side by side."""
