"""`python -m laticauda_swimbench` is `swimbench`."""

import sys

from laticauda_swimbench.app import main

sys.exit(main())
