"""What both sides of a run in virtual time share: the link, and rclpy's endpoints."""
