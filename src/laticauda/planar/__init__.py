"""The paper's closed-form model in the plane: its equations as printed, and the recursion that runs."""
