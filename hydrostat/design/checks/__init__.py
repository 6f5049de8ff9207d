"""What each constraint says of a network: a plain sentence for each place where it is not kept."""
