"""aerocues."""
