"""What the studio keeps of one robot beside the robot itself: plain frozen records."""
