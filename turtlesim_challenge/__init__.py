"""The challenge: draw a four-coloured spiral. This package holds the reference solution."""
