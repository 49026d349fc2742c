"""`airlight benchmark techniques`: what the techniques cost, beside a brute-force march in the same rounds."""
