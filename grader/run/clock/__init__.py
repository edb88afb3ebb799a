"""Virtual time in a submission's process; knows no grading and no observing.

Both sides of the link to the simulator share `grader.run.lockstep`.
"""
