"""Prices in overheats: what orders and entries cost, fitted to simulations, and the cooler plans they lead to."""
