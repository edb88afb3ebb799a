"""A whole class: found in an export, graded in parallel, looked at together."""
