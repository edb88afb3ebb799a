"""What a submission's process is confined with: each module one of the kernel's means, used alone.

Nothing here imports anything but the standard library, and of that nothing slow: a supervisor that
is started as a script loads it before each run.
"""
