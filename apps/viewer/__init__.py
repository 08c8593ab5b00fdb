"""What shows a plan: the page, the interactive viewer, two plans side by side."""
