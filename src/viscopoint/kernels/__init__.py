"""How code is compiled, cached and handed to threads; and the small values that kernels compute with."""
