"""Turtles are spawned, and turtle1 catches them."""
