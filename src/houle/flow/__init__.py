"""Water particles on the grid: the state, the operations of a step, and the step."""
