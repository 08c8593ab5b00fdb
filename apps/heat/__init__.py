"""How hot a plan or a program makes the sheet, by simulation."""
