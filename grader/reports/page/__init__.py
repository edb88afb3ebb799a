"""The HTML page: picture, plots, animation, verdicts."""
