"""What both models do alike: the frame of their plants, and what their kernels know of joints and steps."""
