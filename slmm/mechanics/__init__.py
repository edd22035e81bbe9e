"""What a collection of formulas has: materials, elements, stress, cracks in a line."""
