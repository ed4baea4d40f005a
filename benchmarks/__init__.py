"""Speed and accuracy compared with other packages, in one run on one machine."""
