"""A node that sends Hello World twice a second."""
