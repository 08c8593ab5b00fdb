"""How close is touching, how close is the same."""

TOUCH_MM = 0.01
"""Metal thinner than this is none, and contours nearer than this touch; curves are flattened as finely."""

COINCIDE_MM = 0.02
"""Two curves no further apart than this everywhere are one line drawn twice (each is flattened within 0.01 mm)."""
