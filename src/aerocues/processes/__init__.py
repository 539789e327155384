"""Child processes with limits, and what they tell their parent."""
