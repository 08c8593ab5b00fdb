"""Which burns cover which rings, when, and what of each burn runs on no ring: by intervals, not by samples."""
