"""Phase functions, one file each; `analytic.phase` names them."""
