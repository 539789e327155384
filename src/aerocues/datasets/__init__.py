"""What is measured on: datasets of images and pairs, from folders, benchmarks and simulation."""
