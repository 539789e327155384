"""Finding the best combination for a small part of the cost of measuring all."""
