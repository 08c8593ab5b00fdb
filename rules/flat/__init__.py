"""Rules in MiniZinc: a model file compiled against a nest's facts, and its flat form as statements and verdicts."""
