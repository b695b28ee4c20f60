// Water that crosses from one porosity to another, and remeshing, compiled.
#include <houle/compiled/lists.hpp>

namespace houle {

HOULE_CROSSING(HOULE_COMPILE)

}  // namespace houle
