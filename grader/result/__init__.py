"""The result file: typed, with a schema."""
