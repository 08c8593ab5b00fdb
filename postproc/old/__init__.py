"""Programs that somebody else wrote: what their burns are, told from geometry, and the same burns in another order."""
