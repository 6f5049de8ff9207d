"""What to cut, to stitch, to buy, and whether motors and lines are strong enough."""
