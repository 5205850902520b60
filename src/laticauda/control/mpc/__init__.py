"""Model-predictive guidance, which plans ahead in a current; needs the extra `mpc`."""
