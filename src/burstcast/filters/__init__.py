"""The ensemble square-root filter."""
