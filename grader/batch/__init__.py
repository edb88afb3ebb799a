"""A whole class: find it in an export, grade it in parallel, and compare its hand-ins."""
