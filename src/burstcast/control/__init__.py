"""Control of extreme events: policies, strategies, and the loop that runs flows under them."""
