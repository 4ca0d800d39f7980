"""Presentation of finished campaigns: a page to hand on, and the list of tables."""
