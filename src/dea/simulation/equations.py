"""What the source of a simulation's equations must not hold, since compiled code does not check it.

A branch that no trial run enters is read as well, unless it depends on how many states,
parameters or inputs there are. Not read are functions within the equations, nor what they do with
an argument that they have assigned to.
"""

import ast
import inspect
import textwrap
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from typing import Any


def beyond(function: Callable[..., Any], sizes: Sequence[int]) -> str | None:
    """Return the first literal index of an argument that is beyond its size, as it is written.

    ``sizes`` are those of the function's arguments, in their order. None if there is none, or if
    the source is not at hand.
    """
    tree = _parsed(function)
    if tree is None:
        return None
    nodes = list(_own(tree))
    stored = {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    arguments = zip((each.arg for each in tree.args.args), sizes, strict=False)
    known = {name: size for name, size in arguments if name not in stored}
    for node in nodes:
        if not (isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name)):
            continue
        size, index = known.get(node.value.id), _literal(node.slice)
        if size is not None and index is not None and not -size <= index < size:
            return ast.unparse(node)
    return None


def raising(function: Callable[..., Any]) -> str | None:
    """Return the first statement that raises an exception, as it is written, or None."""
    tree = _parsed(function)
    found = (n for n in _own(tree) if isinstance(n, ast.Raise | ast.Assert)) if tree else iter(())
    first = next(found, None)
    return ast.unparse(first) if first else None


def returning(function: Callable[..., Any]) -> str | None:
    """Return the first statement that returns a value, as it is written, or None."""
    tree = _parsed(function)
    found = (n for n in _own(tree) if isinstance(n, ast.Return)) if tree else iter(())
    first = next((node for node in found if not _nothing(node.value)), None)
    return ast.unparse(first) if first else None


def _nothing(value: ast.expr | None) -> bool:
    return value is None or (isinstance(value, ast.Constant) and value.value is None)


@lru_cache(maxsize=16)
def _parsed(function: Callable[..., Any]) -> ast.FunctionDef | None:
    plain = getattr(function, "py_func", function)
    try:
        module = ast.parse(textwrap.dedent(inspect.getsource(plain)))
    except (OSError, TypeError, SyntaxError):
        return None
    [first, *_] = module.body
    return first if isinstance(first, ast.FunctionDef) else None


def _own(node: ast.AST) -> Iterator[ast.AST]:
    """Yield what a node holds, but no function and no condition on the size of an array."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef | ast.Lambda):
            continue
        if isinstance(child, ast.If | ast.IfExp) and _counts(child.test):
            continue
        yield child
        yield from _own(child)


def _counts(test: ast.expr) -> bool:
    names = {getattr(node, "attr", getattr(node, "id", "")) for node in ast.walk(test)}
    return bool(names & {"size", "shape", "len"})


def _literal(index: ast.expr) -> int | None:
    sign = 1
    if isinstance(index, ast.UnaryOp) and isinstance(index.op, ast.USub):
        sign, index = -1, index.operand
    value = index.value if isinstance(index, ast.Constant) else None
    return sign * value if isinstance(value, int) else None
