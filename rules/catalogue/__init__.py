"""The catalogue: a folder for each rule, with its statements and judgement, cases, text in MiniZinc and picture."""
