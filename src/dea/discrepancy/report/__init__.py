"""The verdict in numbers and words."""
