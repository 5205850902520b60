"""What the joints do: gaits, which say what is asked of them, and actuators, which say what comes of it."""
