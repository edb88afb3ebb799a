"""The repository of a course, for the systems that grade on their own machines."""
