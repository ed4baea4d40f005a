"""Where a module can be changed, and how: cosmic-ray's operators at the places that hold logic."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

import cosmic_ray.plugins
from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from parso.python.tree import Class, Function
from parso.tree import BaseNode, NodeOrLeaf

# One plausible mistake each. Replacements that any call of the function reveals by a TypeError,
# such as `+` by `>>`, and the removal of decorators would only raise the share of mutants killed.
BINARY = (
    "Add_Sub", "Sub_Add", "Mul_Div", "Div_Mul", "FloorDiv_Mul", "Mod_FloorDiv", "Pow_Mul",
    "RShift_LShift", "LShift_RShift", "BitOr_BitAnd", "BitAnd_BitOr", "BitXor_BitAnd",
)  # fmt: skip
COMPARISON = (
    "Lt_LtE", "Lt_Gt", "LtE_Lt", "LtE_GtE", "Gt_GtE", "Gt_Lt", "GtE_Gt", "GtE_LtE",
    "Eq_NotEq", "NotEq_Eq", "Is_IsNot", "IsNot_Is",
)  # fmt: skip
OTHERS = (
    "ReplaceUnaryOperator_Delete_USub", "ReplaceUnaryOperator_Delete_Not",
    "ReplaceUnaryOperator_Delete_Invert", "AddNot", "ReplaceTrueWithFalse", "ReplaceFalseWithTrue",
    "ReplaceAndWithOr", "ReplaceOrWithAnd", "ReplaceBreakWithContinue", "ReplaceContinueWithBreak",
    "ExceptionReplacer", "NumberReplacer", "ZeroIterationForLoop",
)  # fmt: skip
OPERATORS = (
    *(f"ReplaceBinaryOperator_{name}" for name in BINARY),
    *(f"ReplaceComparisonOperator_{name}" for name in COMPARISON),
    *OTHERS,
)
# Messages (`raise`, f-strings), checks for the type checker (`assert`), and what decorates a
# function.
WITHOUT_LOGIC = {
    "raise_stmt", "fstring", "assert_stmt", "decorator", "decorators", "import_from",
}  # fmt: skip


@dataclass(frozen=True)
class Mutant:
    """One change of one module: the ``occurrence``-th of an operator of cosmic-ray."""

    file: str  # relative to the project
    line: int
    column: int
    definition: str  # the innermost function or class around it, or nothing
    operator: str
    occurrence: int

    def apply(self, source: str) -> str:
        """Return the mutated source."""
        mutated = mutate_code(source, _operator(self.operator), self.occurrence)
        if mutated is None:
            raise ValueError(f"{self.file} has no occurrence {self.occurrence} of {self.operator}")
        return str(mutated)

    def is_another_program(self, source: str) -> bool:
        """Return whether the change is valid Python, and more than one of spelling."""
        try:
            return ast.dump(ast.parse(self.apply(source))) != ast.dump(ast.parse(source))
        # AttributeError: cosmic-ray replaces no exception with a dotted name among several.
        except (SyntaxError, AttributeError):
            return False

    def key(self, state: str) -> str:
        """Return a name for this mutant of sources and tests in ``state``."""
        return sha256(f"{self.file} {self.operator} {self.occurrence} {state}".encode()).hexdigest()


def mutants(root: Path, file: Path) -> list[list[Mutant]]:
    """Return the mutants of a module, those of one place in one list."""
    nodes = list(ast_nodes(get_ast(file.read_text())))
    found: dict[tuple[int, int], list[Mutant]] = {}
    for name in OPERATORS:
        operator, occurrence = _operator(name), -1
        for node in nodes:
            for (line, column), _ in operator.mutation_positions(node):
                occurrence += 1
                if _holds_logic(node):
                    mutant = Mutant(
                        str(file.relative_to(root)),
                        line,
                        column,
                        _definition(node),
                        name,
                        occurrence,
                    )
                    found.setdefault((line, column), []).append(mutant)
    return [found[place] for place in sorted(found)]


def _operator(name: str):  # type: ignore[no-untyped-def]
    return cosmic_ray.plugins.get_operator(f"core/{name}")()


def _ancestors(node: NodeOrLeaf) -> Iterator[tuple[BaseNode, NodeOrLeaf]]:
    """Yield each node around this one, with its child on the way."""
    while node.parent is not None:
        yield node.parent, node
        node = node.parent


def _holds_logic(node: NodeOrLeaf) -> bool:
    """Return whether a node is neither an annotation nor text nor a check of an internal belief."""
    if node.type in WITHOUT_LOGIC:
        return False
    if node.parent is not None and node.parent.type in {"parameters", "lambdef"}:
        return False  # the star before arguments that are given by name
    for parent, child in _ancestors(node):
        if parent.type in WITHOUT_LOGIC:
            return False
        if parent.type in {"tfpdef", "annassign"} and parent.children.index(child) in {1, 2}:
            # `name: annotation = value`; of a value, the children start at 3.
            return False
        if parent.type == "param" and child.type == "tfpdef":
            return False
        if isinstance(parent, Function) and child is parent.annotation:
            return False
        if parent.type == "argument" and parent.children[0].get_code().strip() == "strict":
            return False
    return True


def _definition(node: NodeOrLeaf) -> str:
    for parent, _ in _ancestors(node):
        if isinstance(parent, Function | Class) and parent.type != "lambdef":
            return str(parent.name.value)
    return ""
