"""What the nodes share: messages, quality of service, parameters, lifecycle and the loop in time."""
