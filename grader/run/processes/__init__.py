"""Processes of a run: started, watched, kept apart, and ended so that none is left."""

#: The first argument of a program that is to be a zygote; then the socket's number and the
#: grader's process id follow.
ZYGOTE = "--zygote"
