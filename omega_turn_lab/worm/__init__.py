"""`omega_turn worm`: recordings of worms on the command line."""
