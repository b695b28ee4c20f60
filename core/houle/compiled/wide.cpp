// Transfer with the other kernels, and sums over smoothed particles, compiled.
#include <houle/compiled/lists.hpp>

namespace houle {

HOULE_WIDE(HOULE_COMPILE_OF)
HOULE_SPH(HOULE_COMPILE_SPH)

}  // namespace houle
