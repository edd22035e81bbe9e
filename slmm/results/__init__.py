"""Results of other programs: read, joined, sampled, written."""
