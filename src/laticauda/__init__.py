"""laticauda."""
