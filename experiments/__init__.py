"""What is asked: suites, metrics, sheets, and the command line."""
