//! A desk lamp that nods. What it is made of is in `tests`: this package has no code of its own.
