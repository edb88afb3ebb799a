"""The page on which a graded run is seen while it goes on: the simulator's, fed from elsewhere."""
