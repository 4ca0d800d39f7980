"""Presentation of finished campaigns: a page to hand on, docs/results.md, the claims."""
