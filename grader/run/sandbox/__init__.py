"""What a submission's process is confined with: each module one of the kernel's means, used alone.

Nothing here but `view` imports anything but the standard library, and of that nothing slow: a cold
start loads it before each run.
"""
