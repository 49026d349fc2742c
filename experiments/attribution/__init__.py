"""Where a technique's error comes from: split over its parts as Shapley values, by replacing parts with exact ones."""
