"""How sure the intervals are that nobody asks for at another level."""

LEVEL = 0.95
DEVIATIONS = 1.959963984540054  # standard deviations either side that hold it of a normal law
