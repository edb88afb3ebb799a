"""The walker has no nodes of its own."""
