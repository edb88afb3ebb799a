"""Packages that describe robots, examined: which robots, their meshes, and other measures."""
