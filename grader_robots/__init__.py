"""Robots, an extension of the grader: their scene, and the exercises about them."""
