"""What happens in the submission's process of a run.

In real time that is `main`, and `looking`, which stands on `hooks` and what is named beside it. In
virtual time:

| module | what it does |
|---|---|
| `virtual_main` | replaces what tells time, runs the submission with `main` |
| `scheduler` | which thread runs, and when time moves |
| `threads`, `sockets`, `signals` | locks, `select` and asyncio, signals: where threads hand on |
| `clocks`, `chance` | `time` and `datetime`; random numbers and what else differs every time |
| `install` | puts rclpy into virtual time |
| `waiting`, `executor`, `views` | how rclpy's wait sets wait; its executors, faster |
| `graph` | questions about the ROS graph |
| `simulator_link`, `channel` | this end of the link: asks for time, sends and receives |
| `remotes` | the simulator's endpoints, and who hears whom |
| `hooks`, `witness`, `delays` | what is seen of how it uses rclpy, and of how it waits |
| `telling` | how that is told to the grader |
| `deadlock`, `refusal` | what waits for ever, and where; what virtual time cannot follow |

Both sides of the link share `grader.run.lockstep`.
"""
