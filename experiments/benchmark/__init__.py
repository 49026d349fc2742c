"""`airlight benchmark`: what the reference costs, beside Mitsuba's own estimator in the same run."""
