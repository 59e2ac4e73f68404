//! The map of the Duffing equation: largest Lyapunov exponent and period over two of its parameters.
