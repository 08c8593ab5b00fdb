"""Engines: what turns a problem into a route, and the parts they share."""
