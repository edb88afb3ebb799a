"""Into the gradebook: tables, what Moodle and Canvas import, feedback for each student."""
