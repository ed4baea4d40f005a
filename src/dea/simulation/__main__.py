"""Print the page of the documentation on the laws: ``python -m dea.simulation``."""

from dea.simulation.page import page

if __name__ == "__main__":
    print(page(), end="")
