"""Control of events: actuation, strategies, controllers, simulation, costs and scores."""
