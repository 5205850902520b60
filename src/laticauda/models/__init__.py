"""Models of a robot in its surroundings: a scenario goes in, a trial comes out."""
