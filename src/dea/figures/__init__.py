"""One module per figure and table; nothing here computes what a dataset does not hold.

Each module is entered by its own name, so that editing one redraws that one alone.
"""
