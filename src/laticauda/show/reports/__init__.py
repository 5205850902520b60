"""Results prepared for readers: a report, figures and tables in one folder."""
