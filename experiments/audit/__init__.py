"""`airlight audit`: the thesis's equations, as printed and repaired, in the terminal and as a page."""
