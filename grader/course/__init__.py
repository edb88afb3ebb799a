"""What a course begins with: the starter of an exercise, and the repository of a teacher."""
