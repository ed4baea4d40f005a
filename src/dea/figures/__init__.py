"""One module per figure and table; nothing here computes what a dataset does not hold."""
