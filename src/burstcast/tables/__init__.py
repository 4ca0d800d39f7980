"""Tables of parameters, rows of the tables of a case, LaTeX, and the paper's published values."""
