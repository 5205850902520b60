"""Water: loads on an element and on plates, how the water moves, and water for any MuJoCo model."""
