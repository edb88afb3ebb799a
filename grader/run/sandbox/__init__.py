"""Confines a submission's process: each module uses one mechanism of the kernel.

Nothing here but `view` imports anything but the standard library, and of that nothing slow: a cold
start loads it before each run.
"""
