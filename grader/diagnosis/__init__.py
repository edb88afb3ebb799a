"""From all that is known of a run to the one cause that comes first; it never changes points."""
