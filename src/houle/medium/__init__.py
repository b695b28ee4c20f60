"""What the water flows through: shapes, their exact integrals on the grid, porosity, solids, resistance."""
