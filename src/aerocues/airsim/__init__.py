"""Flights in AirSim and Cosys-AirSim: images and ground truth, collected over their protocol."""
