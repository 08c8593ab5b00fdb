"""How a search changes a route: exchanges, ruins that are made good, chains of exchanges, routes merged."""
