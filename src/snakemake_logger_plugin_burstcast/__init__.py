"""Terminal output of a run, as a logger plugin of Snakemake, which finds it by this name."""

from snakemake_logger_plugin_burstcast.terminal import TerminalHandler as LogHandler

__all__ = ["LogHandler"]
