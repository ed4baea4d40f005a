"""What a YAML file holds, with one value changed."""

import copy
from functools import reduce
from operator import getitem

REMOVED = object()


def changed(content, place, value):
    """Return a copy with another value at the end of this path of keys, or with none there."""
    content = copy.deepcopy(content)
    *path, last = place
    inner = reduce(getitem, path, content)
    if value is REMOVED:
        del inner[last]
    else:
        inner[last] = value
    return content
