"""How long work is done: on all cores in order, over even sequences of points, with a word of where it has come to."""
