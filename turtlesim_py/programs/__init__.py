"""The original's other programs: teleop_key, draw_square, mimic."""
