"""The frame of a turtle, sent as a transform."""
