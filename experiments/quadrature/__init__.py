"""How many nodes the airlight needs: `study` measures and tabulates, `tuning` and `thresholds` make the rules."""
