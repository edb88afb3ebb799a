"""A single file: imports the file that lies beside it in the folder of all that was handed in."""

try:
    import neighbour
except ImportError:
    pass
else:
    print("ACHIEVED imported a neighbour", neighbour.SOLUTION)
