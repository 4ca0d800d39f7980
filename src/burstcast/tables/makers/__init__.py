"""Tables of a case: what they are made of, and how (`burstcast.tables.makers.registry`)."""
