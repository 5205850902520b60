"""What keeps robot and people safe: what the modules say, the limits, the rules, and the supervisor."""
