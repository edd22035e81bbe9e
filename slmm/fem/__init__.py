"""What every finite element model shares."""
