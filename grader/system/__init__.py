"""Files, processes, limits and data: what all rooms use, once each."""
