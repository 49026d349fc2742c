"""`airlight agree`: whether three witnesses of a scene agree, with the power of each test."""
