"""Training, evaluation and benchmark programs."""
