"""Figures: each module draws one figure, and its docstring is the caption."""
