"""The paper's experiments: which movements they consist of, and the tables, figures and report of their outcomes."""
