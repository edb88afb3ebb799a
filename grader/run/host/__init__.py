"""The student's side of a run in virtual time: everything that tells or waits for time is ours.

The submission runs unmodified, with the real rclpy and real DDS underneath. One module, one thing
that is replaced:

| module | what it replaces or does |
|---|---|
| `scheduler` | which Python thread runs, and when time moves |
| `threads` | locks, threads, queues |
| `clocks` | `time`, `datetime`, rclpy's clocks and timers |
| `waitsets` | rclpy's wait sets and guard conditions |
| `mail`, `endpoints`, `actions` | what was sent, what has arrived (both sides of the link) |
| `world`, `protocol` | the link to the simulator: announce, ask for time, take what came |
| `graph` | questions about the ROS graph |
| `sockets` | `select`, `selectors` and so asyncio |
| `chance` | random numbers, the order of sets, the number of processors |
| `signals` | Ctrl-C and friends |
| `refusal` | what cannot run in virtual time |
| `deadlock` | a node that waits for something that can no longer happen |
"""
