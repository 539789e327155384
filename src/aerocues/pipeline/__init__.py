"""One core: a combination turns images into features, matches and a verified geometry."""
