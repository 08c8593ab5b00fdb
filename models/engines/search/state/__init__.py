"""What a search holds of a route, as arrays: places, costs of moves, conditions and what breaks them."""
