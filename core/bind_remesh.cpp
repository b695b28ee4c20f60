#include "bind.hpp"

namespace houle {

void bind_remesh(nb::module_&) {}

}  // namespace houle
