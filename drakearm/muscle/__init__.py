"""What a muscle does: curves, activation and contraction, as pure functions compiled with Numba."""
