"""One module per table; nothing here computes what a dataset does not hold.

The function ``tabulate`` of each module makes its table from files. Modules are imported by their
own names, so that an edit of one reruns only the jobs that use it.
"""
