"""What jobs are made from: code, inputs, earlier results, the run that plans them."""
