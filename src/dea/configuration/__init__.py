"""What every configuration file may hold: one module per file or section of it.

A module's models hold the keys, types, ranges, defaults, units and descriptions; the check of a
file, its JSON schema and ``docs/configuration.md`` follow from them. Modules are imported one by
one, so that a job depends on the sections it reads alone.
"""
