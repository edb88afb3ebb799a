"""One graded run: the simulator and the submission, each in a process of its own."""
