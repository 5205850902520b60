"""Linear algebra works in one thread: imported before NumPy, for tests and the programs that they start.

OpenBLAS has a thread for each core, and these wait for one another with the processor at work. Where other tests take
the cores, that is four fifths of the processor time of a test that fits films.
"""

import os

os.environ["OPENBLAS_NUM_THREADS"] = "1"
os.environ["OPENCV_FOR_THREADS_NUM"] = "1"
