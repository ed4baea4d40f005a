"""What the source of a module says of a line: its statement, its function, where that is named."""

import ast
from collections.abc import Iterator
from functools import cache


def statement(source: str, line: int) -> range:
    """Return the lines of the innermost statement around a line; of a compound one, its head."""
    found = range(line, line + 1)
    first = 0
    for node in ast.walk(_parsed(source)):
        if not isinstance(node, ast.stmt | ast.ExceptHandler):
            continue
        body = getattr(node, "body", None)
        last = max(body[0].lineno - 1, node.lineno) if body else node.end_lineno or node.lineno
        if first < node.lineno <= line <= last:
            found, first = range(node.lineno, last + 1), node.lineno
    return found


def in_function(source: str, line: int) -> bool:
    """Return whether a line runs when a function is called, and not when it is imported."""
    return any(
        isinstance(node, ast.FunctionDef) and node.body[0].lineno <= line <= (node.end_lineno or 0)
        for node in ast.walk(_parsed(source))
    )


def compiled(source: str, function: str) -> bool:
    """Return whether numba compiles a function."""
    return any(
        isinstance(node, ast.FunctionDef)
        and node.name == function
        and any("njit" in ast.unparse(each) for each in node.decorator_list)
        for node in ast.walk(_parsed(source))
    )


def mentions(text: str, name: str) -> Iterator[tuple[int, str]]:
    """Yield each line that names a function, and the outermost function around it, or nothing."""

    def visit(node: ast.AST, around: str) -> Iterator[tuple[int, str]]:
        if isinstance(node, ast.Name | ast.Attribute):
            if name == (node.id if isinstance(node, ast.Name) else node.attr):
                yield node.lineno, around
        elif isinstance(node, ast.FunctionDef):
            around = around or node.name
        for child in ast.iter_child_nodes(node):
            yield from visit(child, around)

    yield from visit(_parsed(text), "")


@cache
def _parsed(source: str) -> ast.Module:
    return ast.parse(source)
