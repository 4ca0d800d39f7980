"""Parts that several figures share: style, legends, axes, percentile curves."""
