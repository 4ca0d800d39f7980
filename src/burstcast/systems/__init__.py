"""Dynamical systems, integration, compiled equations, Lyapunov exponents, parameters."""
