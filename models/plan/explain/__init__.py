"""Why a contour of a plan is cut where it is, then, and so."""
