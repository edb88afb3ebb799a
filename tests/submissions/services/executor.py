"""Says whose function waits for what rclpy's executors hand out."""

import rclpy.executors

print(rclpy.executors.Executor._wait_for_ready_callbacks.__module__)
