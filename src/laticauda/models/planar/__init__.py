"""The paper's closed-form planar model: the recursion, the drives and the steps that compute a run."""
