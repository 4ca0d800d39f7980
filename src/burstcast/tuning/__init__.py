"""Hyperparameters of the networks: their search, validation, and the choice by survival."""
