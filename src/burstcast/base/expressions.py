"""Arithmetic expressions of named quantities: read from text, evaluated on arrays.

Only names, numbers, ``+ - * / **``, brackets, and `FUNCTIONS` are understood; no other code is run.
"""

import ast
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, reduce
from typing import NoReturn

import numpy as np

from burstcast.base.arrays import FloatArray

FUNCTIONS: Mapping[str, Callable[[FloatArray], FloatArray]] = {
    "sqrt": np.sqrt,
    "abs": np.abs,
    "exp": np.exp,
    "log": np.log,
}
"""Functions of one argument that an expression may have."""

_LARGEST_PRODUCT = 16
_OPERATIONS: Mapping[type[ast.operator], Callable[[FloatArray, FloatArray], FloatArray]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
}


@dataclass(frozen=True)
class Expression:
    """An arithmetic expression, such as ``0.5 * (u**2 + v**2)``."""

    #: in Python's notation: names, numbers, ``+ - * / **``, brackets, sqrt, abs, exp and log
    text: str

    def __post_init__(self) -> None:
        if not self.names:
            raise ValueError(f"{self.text!r} names no quantity: it is the same number always")

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of quantities in it, in the order of their first use."""
        names: dict[str, None] = {}
        self._collect(self._tree, names)
        return tuple(names)

    def __call__(self, values: Mapping[str, FloatArray]) -> FloatArray:
        """Value for arrays of one shape, by name; each index by itself, in the text's order.

        It is NaN where there is none (the root of a negative number).
        """
        shape = np.shape(values[self.names[0]])
        with np.errstate(all="ignore"):
            result = self._evaluated(self._tree, values)
        return np.broadcast_to(result, shape).copy()

    @cached_property
    def _tree(self) -> ast.expr:
        text = self.text.strip()
        try:
            tree = ast.parse(text, mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            raise ValueError(f"{self.text!r} is no arithmetic expression") from None
        for node in ast.walk(tree):
            if isinstance(node, ast.Name):
                # as the text spells it: Python takes a micro sign for the Greek letter
                node.id = ast.get_source_segment(text, node) or node.id
        return tree

    def _collect(self, node: ast.expr, names: dict[str, None]) -> None:
        """Collect the names below a node; refuse what is not understood."""
        if isinstance(node, ast.Name):
            if node.id in FUNCTIONS:
                raise ValueError(f"{self.text!r}: {node.id} is a function: give it an argument")
            names[node.id] = None
        elif isinstance(node, ast.Constant):
            if not isinstance(node.value, int | float) or isinstance(node.value, bool):
                self._refuse(node)
            if node.value > sys.float_info.max:
                raise ValueError(f"{self.text!r} has a number that is beyond all doubles")
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.UAdd | ast.USub):
            self._collect(node.operand, names)
        elif isinstance(node, ast.BinOp) and type(node.op) in (*_OPERATIONS, ast.Pow):
            self._collect(node.left, names)
            self._collect(node.right, names)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            if node.func.id not in FUNCTIONS or len(node.args) != 1 or node.keywords:
                self._refuse(node)
            self._collect(node.args[0], names)
        else:
            self._refuse(node)

    def _refuse(self, node: ast.expr) -> NoReturn:
        raise ValueError(
            f"{self.text!r}: {ast.unparse(node)} is not understood; an expression has names, "
            f"numbers, + - * / **, brackets, and {', '.join(FUNCTIONS)} of one argument"
        )

    def _evaluated(self, node: ast.expr, values: Mapping[str, FloatArray]) -> FloatArray:
        if isinstance(node, ast.Name):
            # contiguous: numpy's functions may have other last bits where there are strides
            return np.asarray(values[node.id], dtype=np.float64, order="C")
        if isinstance(node, ast.Constant):
            return np.float64(node.value)  # type: ignore[arg-type, return-value]
        if isinstance(node, ast.UnaryOp):
            operand = self._evaluated(node.operand, values)
            return -operand if isinstance(node.op, ast.USub) else operand
        if isinstance(node, ast.Call):
            assert isinstance(node.func, ast.Name)
            return FUNCTIONS[node.func.id](self._evaluated(node.args[0], values))
        assert isinstance(node, ast.BinOp)
        left = self._evaluated(node.left, values)
        if isinstance(node.op, ast.Pow):
            exponent = node.right
            if isinstance(exponent, ast.Constant) and exponent.value in range(1, _LARGEST_PRODUCT):
                # products are exact to the last bit on every machine; powers are not
                return reduce(np.multiply, [left] * int(exponent.value))  # type: ignore[arg-type]
            return np.power(left, self._evaluated(exponent, values))
        return _OPERATIONS[type(node.op)](left, self._evaluated(node.right, values))
