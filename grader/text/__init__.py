"""What people read: messages, their translations, and strangers' text made showable."""
