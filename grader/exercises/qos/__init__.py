"""A relay with the right quality of service."""
