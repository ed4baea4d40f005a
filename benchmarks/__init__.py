"""Comparisons with other packages and methods, and campaigns whose results the documents quote."""
