"""Message catalogues: what pages, work sheets and labels say in other languages than English."""
