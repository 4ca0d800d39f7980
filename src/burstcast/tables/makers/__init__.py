"""Tables of a case: inputs and rows (`burstcast.tables.makers.registry`)."""
