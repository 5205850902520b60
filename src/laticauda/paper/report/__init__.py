"""The report of a reproduction: a folder with figures, tables, trials, and report.html.

- `reproduce`: runs all studies and writes the folder; `workers` divides them among processes.
- `overview`: chapters about all studies, the summary and the claims.
- `efficiency`, `path_following`: the chapter of each study.
- `chapter`, `columns`, `shared_rows`: what the chapters have in common.

Sentences are in `templates`; titles of columns are in `columns.toml`.
"""
