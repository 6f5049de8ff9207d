"""Lists of what to cut, to stitch and to buy, and checks that motors and lines are strong enough."""
