"""What was handed in, and what of it to start; nothing of it is run to find out."""
