"""The robot in space, with MuJoCo: models to simulate and export, the water's loads, and pictures.

It needs the extra `spatial`; the engine is loaded by `door` when it is first needed, and not before.
"""
