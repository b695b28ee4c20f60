#include "bind.hpp"

namespace houle {

void bind_sph(nb::module_&) {}

}  // namespace houle
