"""Water: loads on an element and how the water moves, and water for any MuJoCo model."""
