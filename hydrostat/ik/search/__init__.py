"""From one state to an optimum: models, steps, descents."""
