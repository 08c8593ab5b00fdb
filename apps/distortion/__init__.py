"""How far each part of a plan will be off when it is cold, mm: plane-stress elasticity on a sheet that a kerf opens."""
