"""Speed and accuracy against peers, in one run on one machine."""
