"""Interfaces of one's own."""
