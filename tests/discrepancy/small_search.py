"""A search that finds one strong effect among a few, in a small part of the default's time."""

from dea.discrepancy import Budget

SEARCH = Budget(starts=2, finished=3, shakes=0, exchanges=0, restarted=0)
