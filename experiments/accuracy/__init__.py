"""`airlight accuracy`: how near the repaired thesis comes to the truth, and what brings it nearer."""
