"""Machine code from NumPy expressions, and vectors of trajectories, by LLVM."""
