"""Starts, watches, isolates and ends the processes of a run, so that none is left."""

#: The first argument of a program that is to be a fork server; the socket's number follows.
FORK_SERVER = "--fork-server"
