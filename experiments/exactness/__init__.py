"""`airlight exactness`: whether the controls are what the reference says, so that errors can be blamed on the rest."""
