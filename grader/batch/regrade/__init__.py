"""Judge a graded class by a changed exercise: show the changes, and write them on request."""
