"""What each equation is compared with: one file per part of the thesis, one function per equation."""
