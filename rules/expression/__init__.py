"""What a rule asks of a plan, in one form: YAML and model files are read into it, and it is stated and judged."""
