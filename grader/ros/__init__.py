"""ROS interfaces without a compiler: classes of .msg, .srv and .action, and their bytes.

Beside ROS: `definitions` makes the classes, `messages` serialises their messages, `handles` shows
them to rclpy. Without ROS: `fields` parses definitions, `bag_types` reads recordings by these.
"""
