"""Motion capture for laticauda: one JSON object per UDP datagram."""
