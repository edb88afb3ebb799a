"""Servers that outlive a call of the command line, for who has asked for them.

    the command `grader` --call--> the server of calls --fork--> a process that is this call
                                   its two fork servers --fork--> the fork servers of this call

The server of calls has imported what a grading needs, and has two fork servers as every grader has
them (`grader.run.fork_servers`). None of the three ever does a grading: each call is a fork of the
first, with a fork of each of the others that is its own. So it costs less, and nothing that a
submission does in one grading can reach the next.
"""
