"""A result in many formats, one file each; a report knows verdicts, not checks."""
