"""Virtual time in a submission's process; knows no grading and no observing.

| module | what it does |
|---|---|
| `scheduler` | which thread runs, and when time moves |
| `threads` | locks and threads that pass the baton on |
| `unsupported_calls` | `select`, asyncio, signals; refuses other processes |
| `time_and_chance` | `time` and `datetime`; random numbers and whatever else differs every time |
| `rclpy_time` | puts rclpy into virtual time: wait sets, clocks, queries of the graph |
| `link` | this end of the link to the simulator: asks for time, sends and receives |

Both sides of the link share `grader.run.lockstep`.
"""
