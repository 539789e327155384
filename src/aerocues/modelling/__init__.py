"""What needs both measurements and models: reconstructing the best, and recommending by models."""
