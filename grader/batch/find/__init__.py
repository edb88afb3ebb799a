"""What of a class was handed in, and by whom, as course systems export it."""
