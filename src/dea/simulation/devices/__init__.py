"""The simulations that come with the study; each file defines one as ``simulation``."""
