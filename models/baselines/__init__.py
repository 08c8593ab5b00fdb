"""Plain ways to choose an order, for comparison: at random, and by the temperature of the sheet at that moment."""
