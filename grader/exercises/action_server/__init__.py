"""An action server for Fibonacci's numbers."""
