"""The medium the water flows through: shapes, sections, exact integrals, porosity, solids, columns, resistance."""
