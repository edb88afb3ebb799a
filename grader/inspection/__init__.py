"""A package that is looked at, and not run: the scene `package`."""
