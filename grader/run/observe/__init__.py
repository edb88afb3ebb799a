"""Observes a submission's process for the diagnosis; knows no clock, and changes nothing.

| module | what it does |
|---|---|
| `account` | writes the summary into a page that the grader has as well |
| `witness` | that summary: what the program uses, waits for and lets fail, and how it ended |
| `hooks` | has rclpy's objects call the witness |
| `lines` | which lines have run |
| `files` | the submission's files, and their lines in a stack or a traceback |
| `ending` | how it has ended, or where it is stuck: a deadlock, a loop, an `__init__` |

`grader.run.evidence` reads the page on the grader's side, with `account`, `files` and `ending`.
"""
