"""NC: a plan as the control's program."""
