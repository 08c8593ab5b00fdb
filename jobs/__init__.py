"""Jobs: whole jobs, from a nest and a profile to a plan, its program and the verdict on both."""
