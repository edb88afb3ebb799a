"""A turtle that follows another."""
