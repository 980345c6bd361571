"""Evolve swimming creatures: filaments in a viscous fluid, NEAT inside quality-diversity."""
