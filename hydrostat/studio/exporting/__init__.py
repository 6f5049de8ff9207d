"""Files to take home: the kit, the report, pictures."""
