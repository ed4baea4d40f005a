"""The start of a record that no error counts, for a diagnosis and for the cases made for it."""

LONGEST_WARM_UP = 0.02  # part of a record that it takes at most
