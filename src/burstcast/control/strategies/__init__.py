"""Control strategies: when the actuation is switched on."""
