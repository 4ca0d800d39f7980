"""Controllers: forecasters, committees, random alarms, or none."""
