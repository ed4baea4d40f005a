"""A record made ready to be explained: its samples, their roles, its noise."""
