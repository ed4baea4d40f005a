"""The laws that blind trials hide, from the literature: a module for each kind of law."""
