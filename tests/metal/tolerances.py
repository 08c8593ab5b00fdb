"""Every allowance of the simulation, in one place, each with its reason. All lengths in mm."""

from __future__ import annotations

EDGE_MM = 0.05
"""How far the burnt edge may lie from the drawn contour, to either side: the accuracy that the program promises."""

NUMERIC_MM = 0.01
"""Programs are written to 0.0001 mm; chords and round caps here are true to about 0.005 mm. Twice that is no fault."""

CHORD_MM = 0.003
"""Arcs of drawings and programs are followed by chords that leave them by no more than this."""

RING_MM = EDGE_MM + NUMERIC_MM
"""A torch path this near to a contour's own path is on it; further off it is a lead."""

OVERCUT_MM = 5.0
"""A ring may be cut again for this long where it closes: profiles overcut by 2 mm at most, machines by 4."""

HOLDS_MM = 20.0
"""A piece holds if this much of the sheet's own border is left on it: there it lies on the frame or in the clamps."""

CRUMB_MM2 = 1.0
"""Smaller loose pieces burn up or fall through the grate; nothing can be cut from them."""

CRUMB_WIDTH_MM = 0.2
"""A loose piece nowhere wider than this is dross, not metal."""

CROSSED_MM = 0.1
"""A torch path that runs over loose metal or off the sheet for less than this touches its edge only."""

HELD_BY_MM2 = 50.0
"""A part hangs on so much metal that is not its own, at the least, where tabs hold it."""
