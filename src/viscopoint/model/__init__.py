"""What is simulated and how: body, points, energy balance, guards, simulation. Reading results needs no kernel."""
