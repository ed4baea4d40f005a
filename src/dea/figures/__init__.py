"""One module per figure; nothing here computes what a dataset does not hold.

The function ``draw`` of each module draws its figure from files. Modules are imported by their own
names, so that an edit of one reruns only the jobs that use it. What several figures share is in
``style``, ``lettering``, ``frequency_maps``, ``contours``, ``planes_over_time``, ``h1_over_time``
and ``bench_drawing``; of the diagnosis ``laws`` is a part.
"""
