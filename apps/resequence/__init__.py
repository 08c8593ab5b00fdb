"""Old programs: the same burns in a better order, one program or a folder of them."""
