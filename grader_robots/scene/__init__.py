"""The scene `robot`: a description, what robot_state_publisher makes of joint states, and tf."""
