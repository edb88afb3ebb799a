"""Find hand-ins of a class that behave alike, or have the same sources."""
