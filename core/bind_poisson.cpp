#include "bind.hpp"

namespace houle {

void bind_poisson(nb::module_&) {}

}  // namespace houle
