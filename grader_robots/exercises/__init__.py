"""The exercises about robots, a folder each."""
