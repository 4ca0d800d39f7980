"""Echo state networks: reservoir, open and closed loops, readout, training and tangent."""
