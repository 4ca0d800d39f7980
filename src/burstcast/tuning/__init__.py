"""Hyperparameters of the networks: their search and validation."""
