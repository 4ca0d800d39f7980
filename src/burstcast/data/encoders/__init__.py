"""Encoders: channels that forecasters see in place of the state."""
