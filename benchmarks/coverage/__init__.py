"""How often the 95 % bands of responses and parameters contain the truth of known plants."""
