"""The column of `porous-column` on glass beads: the same comparison, other variants."""

from houle.validation.check import Variant
from houle.validation.engine import comparison

compare = comparison("porous-column").compare

VARIANTS = (Variant(), Variant("dx-10-mm", {"domain.spacing": 0.01}))
