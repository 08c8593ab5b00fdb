"""`kerfwise serve`: the interactive viewer. A server for this machine alone, and the processes that plan for it."""
