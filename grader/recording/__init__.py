"""Recordings of what really happened in a run: in memory, as a rosbag2 folder, and back."""
