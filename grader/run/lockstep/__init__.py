"""What both sides of a run in virtual time share.

Each of the two processes has these put into its rclpy; neither side is imported from here.

| module | what it does |
|---|---|
| `protocol` | what goes over the link between the two processes, and where their time begins |
| `registry` | the readers and writers of a process, and what has arrived |
| `endpoints`, `actions` | rclpy's publishers, subscriptions, clients, services, actions |
| `waitsets` | rclpy's wait sets, timers, clocks, guards, events: they wait in virtual time |
| `contract` | what is assumed of rclpy's inside, and whether it holds |
| `faults` | whose an exception is: the program's or ours |
| `real` | the real clock, kept before it is replaced |
"""
