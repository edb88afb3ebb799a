"""Two nodes of one package, and the launch file that starts them."""
