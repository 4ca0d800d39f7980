"""A benchmark of forecasts of extreme events: frozen cases, files, scores, a leaderboard."""
