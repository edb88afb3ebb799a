"""What a diagnosis is given of a submission's process; knows no clock, and changes nothing.

| module | what it does |
|---|---|
| `account` | the summary that the process keeps of itself, in a page that the grader has as well |
| `witness` | that summary: what the program uses, waits for and lets fail, and how it ended |
| `hooks` | has rclpy's objects call the witness |
| `files` | the submission's own files: which of their lines has led somewhere |
| `stuck` | where a program goes no further: a deadlock, a loop, an `__init__` |

`grader.run.evidence` reads the page on the grader's side, with `account`, `files` and `stuck`.
"""
