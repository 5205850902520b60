"""What all else is made of: declared quantities, values as tables, files, extension points, errors."""
