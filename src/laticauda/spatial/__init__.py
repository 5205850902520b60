"""The robot in space, with MuJoCo: models to simulate and to export.

It needs the extra `spatial`; MuJoCo is loaded when it is first needed, and not before.
"""
