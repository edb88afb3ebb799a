"""The challenge: a spiral in four colours that stops near the edge."""
