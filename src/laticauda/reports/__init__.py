"""Results put together for readers: a report, figures and tables in one folder."""
