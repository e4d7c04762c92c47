"""How a body is discretised: finite elements, material points, and total Lagrangian material points."""
