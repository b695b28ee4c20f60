// The operations of a step on the grid and with the particles, compiled.
#include <houle/compiled/lists.hpp>

namespace houle {

HOULE_FLOW(HOULE_COMPILE)

}  // namespace houle
