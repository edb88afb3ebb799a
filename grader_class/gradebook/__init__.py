"""The gradebook: tables, imports for Moodle and Canvas, feedback for each student."""
