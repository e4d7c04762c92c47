"""The total Lagrangian material point method (de Vaucorbeil, Nguyen & Hutchinson 2020)."""
