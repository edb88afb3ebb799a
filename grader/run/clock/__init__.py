"""Virtual time in a submission's process; knows no grading, and nothing of what is observed.

| module | what it does |
|---|---|
| `scheduler` | which thread runs, and when time moves |
| `threads` | locks and threads: where one hands on |
| `system_calls` | `select`, asyncio, signals; other processes, which it cannot follow |
| `surroundings` | `time` and `datetime`; random numbers and what else differs every time |
| `rclpy_time` | puts rclpy into virtual time: wait sets, clocks, questions about the graph |
| `executor` | its executors, faster |
| `link` | this end of the link to the simulator: asks for time, sends and receives |

Both sides of the link share `grader.run.lockstep`.
"""
