"""Find the submissions of a class, and whose they are, in what course systems export."""
