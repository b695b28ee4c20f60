#include "bind.hpp"

namespace houle {

void bind_transfer(nb::module_&) {}

}  // namespace houle
