"""What both sides of a run in virtual time share.

Each of the two processes has these put into its rclpy; neither side is imported from here.
"""
