"""`python -m laticauda`: the command line, for Python installations whose scripts are not on the path."""

from laticauda.cli import main

if __name__ == "__main__":
    raise SystemExit(main())
