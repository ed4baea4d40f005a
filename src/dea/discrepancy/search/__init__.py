"""Which effects are tried, and how they are fitted."""
