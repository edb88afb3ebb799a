"""What both sides of a run in virtual time share.

Each of the two processes has these put into its rclpy; neither side is imported from here.

| module | what it does |
|---|---|
| `protocol` | what goes over the link between the two processes |
| `link` | how that goes through a socket |
| `registry` | the readers and writers of a process, and what has arrived |
| `endpoints`, `actions` | rclpy's publishers, subscriptions, clients, services, actions |
| `waitsets`, `events` | rclpy's wait sets, timers, guards, events: they wait in virtual time |
| `rclpy_clocks` | rclpy's clocks |
| `contract` | what is assumed of rclpy's inside, and whether it holds |
| `faults` | whose an exception is: the program's or ours |
| `times`, `real` | where virtual time begins; the real clock, kept before it is replaced |
"""
