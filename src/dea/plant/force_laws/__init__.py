"""Force laws by family: beside the kernels of each law, its :class:`~.kind.Kind`.

In a kernel c are the constants, m the memory, y the place and v the velocity.
"""
