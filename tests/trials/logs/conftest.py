from synthetic_trials import full_trial, make_trial

__all__ = ["full_trial", "make_trial"]
