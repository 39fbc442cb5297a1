"""Studies of the program: claims it rests on, and what its methods cost; no product imports them."""
