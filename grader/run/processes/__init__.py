"""Processes of a run: started, watched, kept apart, and ended so that none is left."""

#: The first argument of a program that is to be a fork server; then the socket's number follows.
FORK_SERVER = "--fork-server"
