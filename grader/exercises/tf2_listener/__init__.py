"""One turtle follows another, by transforms."""
