"""Physical quantities, given the real length of a body and the period of its stroke."""
