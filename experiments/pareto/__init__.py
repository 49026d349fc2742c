"""Error against cost: which techniques nothing else beats in both, and what keeps the others from it."""
