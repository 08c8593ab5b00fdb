"""`kerfwise serve`: the page with hands. A server for this machine alone, and the processes that plan for it."""
