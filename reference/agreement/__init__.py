"""Whether independent witnesses of one image agree, and how small a difference the comparison would have noticed."""
