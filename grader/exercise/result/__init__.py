"""The result file and the error file: typed, each with a schema."""
