"""Sentences in the reader's language: made at the end, of a key and values."""
