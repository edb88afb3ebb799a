"""ROS interfaces without a compiler: classes of .msg, .srv and .action, and their bytes.

`definitions` makes the classes, `cdr` serialises their messages, `handles` shows them to rclpy.
"""
