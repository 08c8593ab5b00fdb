"""Plans: made from a solution, read back, explained; and what to do when the hard rules contradict each other."""
