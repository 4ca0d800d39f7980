"""What a finished campaign is shown with: a page to hand on, docs/results.md, the claims."""
