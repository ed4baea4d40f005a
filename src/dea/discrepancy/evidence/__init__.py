"""What speaks for and against a missing effect."""
