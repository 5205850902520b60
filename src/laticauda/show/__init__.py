"""What looks at trials: figures, films and pictures, reports, and the cockpit."""
