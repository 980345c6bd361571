"""Choices: creatures that people choose for the next generations to descend from."""
