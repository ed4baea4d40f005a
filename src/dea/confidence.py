"""The level of confidence of every interval for which no other level is asked."""

LEVEL = 0.95
DEVIATIONS = 1.959963984540054  # standard deviations either side that hold it of a normal law
