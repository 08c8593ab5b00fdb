"""The clock: plans and programs over time, and the heat they leave."""
